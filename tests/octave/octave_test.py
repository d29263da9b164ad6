"""run.mat: the numbers of run.h5 in Octave, with their names and units; drawn. Skipped (77) where octave-cli is not here."""
import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CODE = """
addpath('{octave}');
run = schuler_load('{out}');
assert(size(run.solution.position, 2), 3);
assert(run.solution.units.position, 'deg,deg,m');
assert(run.solution.columns.position, {{'lat', 'lon', 'height'}});
assert(isa(run.solution.time_ns, 'int64'));
assert(run.name, 'demo');
assert(numel(strfind(run.config, '[imu]')) > 0);
rows = csvread('{out}/solution.csv', 1, 0);
assert(rows(:, 1), run.solution.time_s, 1e-5);
assert(rows(:, 2:3), run.solution.position(:, 1:2), 1e-9);
assert(rows(:, 4), run.solution.position(:, 3), 1e-4);
plain = load('{out}/run.h5');                       % transposed there
assert(plain.solution.velocity', run.solution.velocity);
assert(plain.innovations.gnss_position.sigma', run.innovations.gnss_position.sigma);
assert(run.innovations.gnss_position.units.sigma, 'SI');
assert(size(run.covariance, 1), size(run.covariance, 2));
assert(plain.covariance(:, :, 2)', run.covariance(:, :, 2));
caught = '';
try, schuler_load('{octave}/schuler_load.m'); catch e, caught = e.message; end
assert(! isempty(caught));
try, schuler_plot(run, 'solution', 'velocty'); catch e, caught = e.message; end
assert(! isempty(strfind(caught, 'velocity')));
if any(strcmp(available_graphics_toolkits(), 'gnuplot')) || any(strcmp(available_graphics_toolkits(), 'qt'))
    figure('visible', 'off');
    axes = schuler_plot(run, 'solution', 'attitude');
    assert(get(get(axes(3), 'ylabel'), 'string'), 'heading, deg');
    schuler_plot(run, 'innovations.gnss_position', 'innovation');
    schuler_plot(run, 'solution', 'position');
    disp('drawn');
else
    disp('not drawn: no graphics toolkit');
end
disp('good');
"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--source", required=True, type=Path)
    a = parser.parse_args()
    octave = shutil.which("octave-cli")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        command = [a.program, "run", a.source / "examples/demo.toml", "--outputs", "solution,summary,h5,mat,covariance", "--stop", "200", "-q", "-o"]
        subprocess.run([*command, out], check=True, capture_output=True, timeout=200)
        subprocess.run([*command, Path(folder) / "again"], check=True, capture_output=True, timeout=200)
        first, second = (out / "run.mat").read_bytes(), (Path(folder) / "again/run.mat").read_bytes()
        if first != second:
            sys.exit("the same run gave two files run.mat that differ")
        if octave is None:
            print("skipped: octave-cli is not here")
            sys.exit(77)
        done = subprocess.run([octave, "--norc", "--eval", CODE.format(octave=a.source / "octave", out=out)], capture_output=True, text=True,
                              timeout=200, cwd=folder)
        print(done.stdout, done.stderr)
        if done.returncode != 0 or "good" not in done.stdout:
            sys.exit("Octave does not read it as it should")


if __name__ == "__main__":
    main()

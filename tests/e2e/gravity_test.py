"""`schuler gravity` from outside: files, numbers, injected disturbances, refusals."""
import json
import subprocess
from pathlib import Path

from program_test import check, main

SURVEY = """name = "survey"
seed = 4
duration_s = 900
[trajectory]
type = "great_circle"
start = { lat_deg = 55.8, lon_deg = 37.5, height_m = 164.0 }
heading_deg = 45
speed_m_s = 10
[[anomaly]]
kind = "constant"
size_mgal = [0, 0, 10]
[imu]
rate_hz = 2
grade = "perfect"
gyro_turn_on_bias_deg_h = 0.01
gyro_noise_deg_sqrt_h = 1.2e-4
accel_turn_on_bias_mg = 1e-4
accel_noise_m_s_sqrt_h = 4.2e-5
[gnss]
white_m = [0.05, 0.05, 0.05]
white_velocity_m_s = [0.05, 0.05, 0.05]
[filter]
initial_error = { level_deg = 0.005, heading_deg = 0.05, velocity_m_s = 0.01, position_m = 1 }
[gravity]
model = "constant"
prior_mgal = [10, 10, 10]
"""


def not_to_be_used(program, *arguments):
    """Runs a survey that is judged not to be used: everything is written, the exit status is 1."""
    done = subprocess.run([program.path, "gravity", *map(str, arguments), "--json"], cwd=program.folder, capture_output=True, text=True, timeout=200,
                          stdin=subprocess.DEVNULL)
    found = json.loads(done.stdout)["gravity"]
    check(done.returncode == 1 and not found["usable"] and found["judged"]["reasons"] and "schuler: do not use: " in done.stderr,
          f"{arguments}: status {done.returncode}, {found['judged']}, {done.stderr!r}")
    return found


def gravity(program, source):
    folder = Path(program.folder)
    (folder / "survey.toml").write_text(SURVEY)
    summary = json.loads(program("gravity", "survey.toml", "-o", "g", "--json").stdout)
    found = summary["gravity"]
    check(summary["command"] == "gravity" and found["usable"], "a survey with a gravimeter's accelerometers is usable")
    check(summary["verdict"] is None, f"a survey is judged by its own figures, not by a verdict that was never formed: {summary['verdict']}")
    up = found["vertical_mgal"]
    check(abs(up["estimate"] - 10.0 - up["final"]) < 1e-9, "estimate less truth is the error")
    check(up["sigma"] < 0.5 and abs(up["final"]) < 4 * up["sigma"], f"vertical {up} within four sigma")
    check(found["east_mgal"]["sigma"] > 5.0, "a horizontal disturbance is not told from tilt")
    lines = (folder / "g/gravity.csv").read_text().splitlines()
    check(len(lines) == found["epochs"] + 1 and "disturbance_up_mgal" in lines[0], "gravity.csv has the epochs")
    check(abs(float(lines[-1].split(",")[lines[0].split(",").index("gravity_disturbance_mgal")]) + up["estimate"]) < 1e-3,
          "stronger gravity is positive in gravity_disturbance_mgal")
    told = program("gravity", "survey.toml", "-o", "told", "--set", "filter.integrity.use=true", "--set", "mag.heading_std_deg=9").stderr
    check(all(f"{key} is given and has no effect: gravimetry" in told for key in ("filter.integrity.use", "mag.heading_std_deg")), f"what is switched off is named: {told}")
    told = program("gravity", "survey.toml", "-o", "told", "--set", "gravity.steps_s=[20000]", "--set", "filter.preset=tight").stderr
    check("20000 s lies outside the survey" in told and "filter.preset is given and has no effect: gravimetry" in told, f"a step that never comes, a preset: {told}")
    points = json.loads((folder / "g/gravity.geojson").read_text())["features"]
    check(len(points) == found["epochs"] and abs(points[0]["geometry"]["coordinates"][1] - 55.8) < 0.1, "gravity.geojson has them too")
    check("Disturbance of gravity" in (folder / "g/report.html").read_text(), "the report shows it")

    # The filter backward in time: the same estimate, and its difference from the forward one with a sigma.
    both = json.loads(program("gravity", "survey.toml", "-o", "b", "--backward", "--json").stdout)
    check(both["gravity"]["vertical_mgal"] == up and found["separation"] is None, "a backward filter changes nothing else")
    for axis in ("vertical_mgal", "north_mgal", "east_mgal"):
        check(both["gravity"]["separation"][axis]["inside_3sigma"] > 0.97, f"both filters agree within three sigma: {both['gravity']['separation']}")
    check(both["separation"]["epochs"] > 100 and "separation up" in (folder / "b/report.html").read_text(), "positions are compared too; a plot")
    head, *rows = [line.split(",") for line in (folder / "b/gravity.csv").read_text().splitlines()]
    middle = dict(zip(head, rows[len(rows) // 2]))
    check(0.0 < float(middle["std_separation_up_mgal"]) and abs(float(middle["separation_up_mgal"])) < 5 * float(middle["std_separation_up_mgal"]),
          f"the table has it: {middle}")
    campaign = json.loads(program("gravity", "survey.toml", "--backward", "--runs", "2", "--json").stdout)["errors"]
    check("separation up" in campaign and campaign["separation up"]["nees"] > 0.0, "a campaign tells whether its sigma is right")

    # Simulated logs and a scenario give the same; a step injected into the logs is found.
    program("simulate", "survey.toml", "-o", "logs")
    again = json.loads(program("gravity", "logs", "-o", "h", "--json").stdout)["gravity"]["vertical_mgal"]
    check(again["estimate"] == up["estimate"] and again["final"] is None, "the logs of the scenario give the same, without a truth")
    (folder / "step.toml").write_text('[[anomaly]]\nkind = "constant"\nsize_mgal = [0, 0, -3]\n')
    injected = json.loads(program("gravity", "logs", "-o", "i", "--config", "step.toml", "--json").stdout)["gravity"]["vertical_mgal"]
    check(abs(injected["estimate"] - up["estimate"] + 3.0) < 0.02, f"an injected disturbance is found: {injected}")

    # The loops agree where the errors stay small, the smoother works in each, and the summary says which it was.
    for loop in ("open", "mixed"):
        other = json.loads(program("gravity", "survey.toml", "-o", "l", "--loop", loop, "--set", "filter.feedback_period_s=200",
                                   "--json").stdout)
        apart = abs(other["gravity"]["vertical_mgal"]["estimate"] - up["estimate"])
        check(other["loop"] == loop and 0 < apart < 0.02, f"loop {loop}: {apart} mGal from the closed one")
    # A disturbance that bends: a parabola along the track is found by a model that has one.
    bent = SURVEY.replace('kind = "constant"\nsize', 'kind = "harmonic"\nlength_m = 45000\nsize')
    spreads = {}
    for model in ("constant", "quadratic"):
        (folder / "bent.toml").write_text(bent + "sigma_mgal = [0, 0, 0]\nslope_mgal_km = 2\ncurvature_mgal_km2 = 1\n")
        survey = ("bent.toml", "-o", "q", "--set", f"gravity.model={model}")
        found = not_to_be_used(program, *survey) if model == "constant" else json.loads(program("gravity", *survey, "--json").stdout)["gravity"]
        spreads[model] = found["vertical_mgal"]["spread"]
    check(spreads["quadratic"] < 0.3 < 1.0 < spreads["constant"], f"a parabola follows what a constant does not: {spreads}")

    runs, alone = (json.loads(program("gravity", "survey.toml", "--runs", 3, "--threads", n, "--json").stdout) for n in (3, 1))
    check(runs["errors"] == alone["errors"] and runs["montecarlo"]["failed"] == alone["montecarlo"]["failed"],
          f"runs do not depend on --threads: {runs['errors']}, {alone['errors']}")
    check(runs["montecarlo"]["runs"] == 3 and runs["errors"]["disturbance up"]["median"] < 1.0, "--runs tells medians")
    response = json.loads(program("gravity", "survey.toml", "--response", "-o", "r", "--json").stdout)
    check(response["response"][-1]["forward"]["gain"] < 0.7, "a model of a constant follows no harmonic")

    # The filter's expectation of the fixes: kept by the model of the truth, broken by a model of a constant over a wave.
    seen = found["innovations"]
    check(seen["low"] < 1.0 < seen["high"] and 0.97 * seen["low"] < seen["nis"] < 1.03 * seen["high"], f"innovations {seen}")
    wave = 'kind = "harmonic"\nlength_m = 900\nsize_mgal = [0, 0, 100]'
    (folder / "wave.toml").write_text(SURVEY.replace('kind = "constant"\nsize_mgal = [0, 0, 10]', wave))
    seen = not_to_be_used(program, "wave.toml", "-o", "w")["innovations"]
    check(seen["nis"] > 1.1 * seen["high"], f"a wave under a model of a constant breaks the innovations: {seen}")

    # A log of velocity, gauges and a compass: written, read again, taken; the innovations are of the fixes and stay what they were.
    aids = ("[log]\nrate_hz = 1\nscale_factor_ppm = 3000\nmisalignment_deg = 0.3\n[compass]\nrate_hz = 1\nbias_deg = 1\n"
            "[gauges]\nrate_hz = 1\nbias_m = 2\nlever_arms_m = [[0, 0, 1], [10, 0, 1], [0, 4, 1]]\n")
    (folder / "aided.toml").write_text(SURVEY + aids)
    aided = json.loads(program("gravity", "aided.toml", "-o", "a", "--json").stdout)["gravity"]
    seen, better = aided["innovations"], aided["vertical_mgal"]
    check(0.97 * seen["low"] < seen["nis"] < 1.03 * seen["high"], f"innovations with aids {seen}")
    check(abs(better["final"]) < 4 * better["sigma"] and better["sigma"] <= up["sigma"], f"more measurements, less sigma: {better}")
    program("simulate", "aided.toml", "-o", "aided_logs")
    again = json.loads(program("gravity", "aided_logs", "-o", "b", "--json").stdout)["gravity"]["vertical_mgal"]
    check(again["estimate"] == better["estimate"], "the logs of the aided scenario give the same")
    (folder / "aided_logs/compass.csv").write_text("time_s,heading_deg\n0,45\n0,46\n")
    program.fails("gravity", "aided_logs", parts=["compass.csv:3", "time_s", "does not rise"])

    # A survey over a field of the ground: the crossovers are those of the disturbance itself.
    example = json.loads(program("gravity", source / "examples/gravity-survey.toml", "-o", "s", "--json").stdout)["gravity"]
    cross = example["crossovers"]
    check(cross["count"] >= 8 and cross["levelled_rms_mgal"] < cross["rms_mgal"] < 2.0, f"crossovers over the ground {cross}")
    check(example["vertical_mgal"]["spread"] < 1.0, "the field is found but for its level")

    # A bias of 5 mGal hides the level and not a step of it; a scenario keeps its [gravity] section without an [[anomaly]].
    rest = SURVEY[SURVEY.index("[imu]"):].replace("accel_turn_on_bias_mg = 1e-4", "accel_turn_on_bias_mg = 5.1e-3")
    still = ('name = "rest"\nduration_s = 2000\n[trajectory]\ntype = "static"\nstart = { lat_deg = 55.8, lon_deg = 37.5, height_m = 100 }\n' +
             rest + "steps_s = [1000]\n")
    (folder / "rest.toml").write_text(still)
    program("simulate", "rest.toml", "-o", "rest")
    check("steps_s = [1000" in (folder / "rest/dataset.toml").read_text(), "the section [gravity] is kept without an anomaly")
    (folder / "inject.toml").write_text('[[anomaly]]\nkind = "step"\nstart_s = 1000\nsize_mgal = [0, 0, -3]\n')
    half_real = json.loads(program("gravity", "rest", "-o", "half", "--config", "inject.toml", "--json").stdout)["gravity"]
    change = half_real["changes"][0]["vertical_mgal"]
    check(abs(change["change"] + 3.0) < 3.0 * change["sigma"] and change["sigma"] < 1.0, f"the step is found with its sigma: {change}")
    check(half_real["attainable_vertical_mgal"] > 3.0, "where the level is not")

    # An open loop that has left its linear model is not to be used.
    not_to_be_used(program, source / "examples/gravity-car-5400s.toml", "-o", "far", "--loop", "open", "--seed", 801)
    # ... also while only the horizontal channels and the innovations show it, without a truth, and over seeds.
    (folder / "car.toml").write_text((source / "examples/gravity-car-5400s.toml").read_text().replace("duration_s = 5400", "duration_s = 2700"))
    bad = not_to_be_used(program, "car.toml", "-o", "near", "--loop", "open", "--seed", 4)
    check(any("north" in reason for reason in bad["judged"]["reasons"]), f"the horizontal components are judged: {bad['judged']}")
    program("simulate", "car.toml", "-o", "car", "--seed", 4)
    (folder / "car/reference.csv").unlink()
    toml = folder / "car/dataset.toml"
    toml.write_text("".join(line for line in toml.read_text().splitlines(keepends=True) if "reference.csv" not in line))
    not_to_be_used(program, "car", "-o", "blind", "--loop", "open")
    many = subprocess.run([program.path, "gravity", "car.toml", "--loop", "open", "--seed", "4", "--runs", "3"], cwd=program.folder, capture_output=True, text=True,
                          timeout=200)
    told = many.stdout + many.stderr
    check("surveys are not to be used" in told and many.returncode == ("do not use: " in told), f"a campaign is judged: {many.returncode} {told!r}")

    # Logs that cannot show gravity say so instead of numbers.
    (folder / "poor.toml").write_text(SURVEY.replace('accel_turn_on_bias_mg = 1e-4', "accel_turn_on_bias_mg = 2"))
    poor = program("gravity", "poor.toml", "-o", "p", "--json")
    found = json.loads(poor.stdout)["gravity"]
    check(not found["usable"] and found["vertical_mgal"]["estimate"] is None and "cannot show" in found["statement"], "no nonsense")
    check(not (folder / "p/gravity.csv").exists() and "cannot show" in poor.stderr, "no file of nonsense")

    for wrong, parts in ((SURVEY.replace("size_mgal = [0, 0, 10]", "size_mgal = [0, 10]"), ["wrong.toml:9", "anomaly", "size_mgal"]),
                         (SURVEY.replace('kind = "constant"', 'kind = "bump"'), ["anomaly", "bump", "harmonic"]),
                         (SURVEY.replace("prior_mgal", "prior_mgals"), ["prior_mgals", "gravity.prior_mgal"]),
                         (SURVEY.replace("[gravity]", "[gravity]\nsteps_s = 5"), ["steps_s"]),
                         (SURVEY.replace('model = "constant"', 'model = "quadratic"'),
                          ["wrong.toml:25", "gravity.model", "give gravity.slope_mgal_km"]),
                         (SURVEY.replace('model = "constant"', 'model = "quadratic"') + "slope_mgal_km = 1\n",
                          ["wrong.toml:25", "gravity.model", "give gravity.curvature_mgal_km2"]),
                         (SURVEY.replace('model = "constant"', 'model = "cubic"'), ["wrong.toml:25", "cubic", "quadratic"]),
                         (SURVEY + "curvature_mgal_km2 = -1\n", ["wrong.toml:27", "curvature_mgal_km2"]),
                         (SURVEY.replace("[gravity]", 'loop = "ajar"\n[gravity]'),
                          ["wrong.toml:24", "filter.loop", "ajar", "mixed"])):
        (folder / "wrong.toml").write_text(wrong)
        program.fails("gravity", "wrong.toml", parts=parts)
    program.fails("gravity", "nowhere", parts=["nowhere"])
    program.fails("gravity", "logs", "--runs", 2, parts=["scenario"])
    ranks = json.loads(program("analyze", "observability", "--vn", 1, "--ve", 1, "--json").stdout)
    check(ranks["rank"] == 22 and ranks["states"] == 27 and len(ranks["pivots"]) == 22, "rank of the moving system")
    program.fails("analyze", "observability", "--latitude-deg", 90, parts=["--latitude-deg"])
    ranks = json.loads(program("analyze", "observability", "--vn", 1, "--ve", 1, "--polynomial", 2, "--json").stdout)
    check(ranks["rank"] == 28 and ranks["states"] == 33, "rank of a parabola along the track")
    program.fails("analyze", "observability", "--polynomial", 3, parts=["--polynomial", "0 to 2"])


if __name__ == "__main__":
    main({"gravity": gravity})

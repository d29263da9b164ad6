"""Whole programs as functions: the numbers of the program, its options as keywords, its errors as exceptions."""
import csv
import json
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
import warnings
from unittest import mock

from support import FOLDER, drive, main, program, scenario

import numpy as np
import schuler


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(line for line in file if not line.startswith("#")) if row]
    return rows[0], np.array([[float(x) if x else np.nan for x in row] for row in rows[1:]])


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.out = FOLDER / "process-out"
        done = program("process", drive(), "-o", cls.out, "--smooth", "--json")
        assert done.returncode == 0, done.stderr
        cls.document = json.loads(done.stdout)
        cls.result = schuler.process(drive(), smooth=True)

    def test_numbers_are_the_programs(self):
        names, rows = rows_of(self.out / "solution.csv")
        column = {name: rows[:, i] for i, name in enumerate(names)}
        solution = self.result.solution
        self.assertEqual(len(solution), len(rows))
        self.assertGreater(len(rows), 1000)
        np.testing.assert_allclose(solution.time_s, rows[:, 0], atol=2e-6)
        np.testing.assert_allclose(solution.position[:, 0], column["lat_deg"], atol=1e-9)
        np.testing.assert_allclose(solution.attitude[:, 2], column["heading_deg"], atol=1e-5)

    def test_same_bits_as_run_h5(self):
        again = schuler.process(drive(), smooth=True, output=FOLDER / "process-again", outputs="h5")
        for name in ("position", "velocity", "attitude", "std_attitude"):
            np.testing.assert_array_equal(again.solution[name], self.result.solution[name])
        self.assertTrue((FOLDER / "process-again/run.h5").is_file())

    def test_summary(self):
        mine, theirs = self.result.summary, self.document
        self.assertEqual({k: v for k, v in mine.items() if k not in ("timing", "settings", "outputs")}.keys(),
                         {k: v for k, v in theirs.items() if k not in ("timing", "settings", "outputs")}.keys())
        self.assertEqual(mine["errors"] if "errors" in mine else mine["evaluation"], theirs["errors"] if "errors" in theirs else theirs["evaluation"])

    def test_covariance(self):
        result = schuler.process(drive(), outputs="h5,covariance", self_check=False, smooth=False)
        P, states = result["covariance"].covariance, result["covariance"].attributes["states"]
        self.assertEqual(P.shape[1:], (len(states), len(states)))
        np.testing.assert_allclose(P, np.swapaxes(P, 1, 2), rtol=1e-9, atol=1e-18)
        self.assertEqual(result.solution.time_ns.dtype, np.int64)
        np.testing.assert_allclose(np.sqrt(P[-1, 2, 2]), result.solution.std_position[-1, 2], rtol=0.05)
        self.assertNotIn("covariance_smoothed", result.tables)
        smoothed = schuler.process(drive(), outputs="h5,covariance", self_check=False, smooth=True)
        self.assertIn("covariance_smoothed", smoothed.tables)
        table = smoothed["covariance_smoothed"]
        self.assertEqual(table.covariance.shape, smoothed["covariance"].covariance.shape)
        np.testing.assert_allclose(np.sqrt(table.covariance[50, 2, 2]), smoothed.solution.std_position[50, 2], rtol=0.05)

    def test_tables_carry_units(self):
        self.assertEqual(self.result.solution.units["position"], ("deg", "deg", "m"))
        si = self.result.solution.si()
        self.assertEqual(si.units["position"], ("rad", "rad", "m"))
        np.testing.assert_allclose(si.position[:, :2], np.radians(self.result.solution.position[:, :2]), rtol=1e-15)
        np.testing.assert_array_equal(si.position[:, 2], self.result.solution.position[:, 2])
        self.assertEqual(self.result["innovations/gnss_position"].innovation.shape[1], 3)
        with self.assertRaisesRegex(schuler.Error, "did you mean solution"):
            self.result["soluton"]

    def test_pandas(self):
        try:
            import pandas  # noqa: F401
        except ImportError:
            with self.assertRaisesRegex(schuler.Error, "pandas"):
                self.result.solution.to_pandas()
            return
        frame = self.result.solution.to_pandas()
        np.testing.assert_array_equal(frame["position_lat_deg"], self.result.solution.position[:, 0])

    def test_temporary_folder_goes_with_the_result(self):
        result = schuler.simulate(scenario())
        folder = result.folder
        self.assertTrue((folder / "imu.csv").is_file())
        del result
        self.assertFalse(folder.exists())

    def test_other_commands(self):
        self.assertIn("imu", schuler.inspect(drive()).text)
        evaluated = schuler.evaluate(self.out / "solution.csv", drive() / "reference.csv")
        self.assertTrue(evaluated.summary)
        self.assertEqual(schuler.analyze.equator(speed=600, height=10000, time=3600, dh=1).summary,
                         json.loads(program("analyze", "equator", "--speed", 600, "--height", 10000, "--time", 3600, "--dh", 1, "--json").stdout))
        self.assertIn("solution", schuler.ahrs(drive()).tables)
        self.assertEqual(schuler.analyze.requirements(outage=60).summary, json.loads(program("analyze", "requirements", "--outage", 60, "--json").stdout))
        printed = schuler.paper("C", "table-2")
        self.assertIn("printed", printed.text)
        self.assertRegex(schuler.batch([drive()]).text, r"drive +(trustworthy|care)")
        several = schuler.montecarlo(scenario(), runs=2, jobs=2, stop=60)
        self.assertTrue(several.tables)
        self.assertIn("solution", schuler.run(scenario(), seed=3).tables)


class Keywords(unittest.TestCase):
    def test_unknown_ones(self):
        for call, name, near in ((lambda: schuler.process(drive(), smoot=True), "smoot", "smooth"),
                                 (lambda: schuler.process(drive(), gnss_latency=1), "gnss_latency", "gnss_latency_s"),
                                 (lambda: schuler.process(drive(), settings={"imu.grad": "mems"}), "imu.grad", "imu.grade"),
                                 (lambda: schuler.analyze.equator(sped=1), "sped", "speed")):
            with self.assertRaises(schuler.Error) as caught:
                call()
            self.assertEqual(caught.exception.key, name)
            self.assertIn(near, caught.exception.hint)
            self.assertEqual(caught.exception.kind, "input")

    def test_wrong_values(self):
        for call, key in ((lambda: schuler.process(drive(), output_rate=-1), "output-rate"),
                          (lambda: schuler.process(drive(), scheme="lose"), "scheme"),
                          (lambda: schuler.process(drive(), imu_grade=3), "imu.grade"),
                          (lambda: schuler.montecarlo(scenario(), runs=0), "runs")):
            with self.assertRaises(schuler.Error) as caught:
                call()
            self.assertIn(key, str(caught.exception))
        with self.assertRaisesRegex(schuler.Error, "missing"):
            schuler.process()
        with self.assertRaisesRegex(schuler.Error, "2 are given"):
            schuler.process(drive(), 3)

    def test_a_setting_by_three_ways(self):
        ways = [{"gnss_default_std_m": [9, 9, 9]}, {"settings": {"gnss.default_std_m": np.array([9.0, 9.0, 9.0])}},
                {"settings": {"gnss": {"default_std_m": (9, 9, 9)}}}]
        for way in ways:
            result = schuler.process(drive(), self_check=False, outputs="config,h5", **way)
            self.assertIn("default_std_m = [9", (result.folder / "config.toml").read_text())

    def test_outages(self):
        result = schuler.process(drive(), outage=[(90, 5), "100:5"], self_check=False)
        self.assertEqual(len(result.summary["outages"]), 2)

    def test_signature_and_documentation(self):
        import inspect
        parameters = inspect.signature(schuler.process).parameters
        self.assertIn("smooth", parameters)
        self.assertIn("output_rate", parameters)
        self.assertIn("rate of the solution", schuler.process.__doc__)


class Errors(unittest.TestCase):
    def test_parts(self):
        folder = FOLDER / "bad"
        folder.mkdir()
        (folder / "dataset.toml").write_text("[imu]\nfile = \"imu.csv\"\ngrad = \"mems\"\n")
        with self.assertRaises(schuler.Error) as caught:
            schuler.process(folder)
        e = caught.exception
        self.assertEqual((e.line, e.key), (3, "imu.grad"))
        self.assertTrue(e.file.endswith("dataset.toml"))
        self.assertIn("imu.grade", e.hint)
        self.assertEqual(str(e), program("process", folder).stderr.strip().removeprefix("schuler: "))

    def test_a_verdict_against_it_warns(self):
        with mock.patch("warnings.warn") as warn:
            outcome = mock.Mock(text="", json="", warnings=[], verdict="do not use", usable=False, notice="", files=[], folder="")
            from schuler._result import Result
            Result("process", outcome)
            self.assertEqual(warn.call_args.args[1], schuler.NotTrustworthy)
        warnings.resetwarnings()


class Running(unittest.TestCase):
    def test_progress_and_threads(self):
        shares, ticks, done = [], [], threading.Event()

        def tick():
            while not done.wait(0.005):
                ticks.append(time.monotonic())

        other = threading.Thread(target=tick)
        other.start()
        schuler.montecarlo(scenario(), runs=4, jobs=2, progress=shares.append)
        done.set()
        other.join()
        self.assertTrue(shares and shares == sorted(shares) and shares[-1] == 1.0, shares)
        self.assertGreater(len(ticks), 10, "another thread ran meanwhile")

    def test_an_exception_of_the_callback_ends_it(self):
        def stop(_):
            raise RuntimeError("enough")
        begin = time.monotonic()
        with self.assertRaisesRegex(RuntimeError, "enough"):
            schuler.montecarlo(scenario(), runs=1000, jobs=2, progress=stop)
        self.assertLess(time.monotonic() - begin, 60)

    def test_control_c(self):
        code = (f"import schuler\ntry:\n    schuler.montecarlo({str(scenario())!r}, runs=1000, jobs=2, progress=lambda p: print('on', flush=True))\n"
                "except KeyboardInterrupt:\n    print('interrupted')\n")
        child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "on\n")
        child.send_signal(signal.SIGINT)
        out, _ = child.communicate(timeout=60)
        self.assertIn("interrupted", out)
        self.assertEqual(child.returncode, 0)

    def test_two_threads_at_once(self):
        results = [None, None]

        def work(i):
            results[i] = schuler.process(drive(), self_check=False).solution.position

        threads = [threading.Thread(target=work, args=(i,)) for i in (0, 1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        np.testing.assert_array_equal(*results)


if __name__ == "__main__":
    os.chdir(FOLDER)
    main()

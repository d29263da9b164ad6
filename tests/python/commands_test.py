"""The commands that no other test calls, and every study; what is public is documented with units and shapes."""
import inspect
import io
import pydoc
import re
import unittest

from support import FOLDER, drive, main, program

import schuler

CAR = """name = "car"
duration_s = 60
[trajectory]
type = "car"
start = { lat_deg = 50, lon_deg = 30, height_m = 100 }
[imu]
rate_hz = 50
grade = "mems"
[gnss]
rate_hz = 1
[ranges]
rate_hz = 1
rinex = true
"""
FILTER = "[filter]\ninitial_error = { level_deg = 0.05, heading_deg = 1, velocity_m_s = 0.1, position_m = 2 }\n"


def made(name, text, folder=None):
    file = FOLDER / f"{name}.toml"
    file.write_text(text)
    if folder:
        done = program("simulate", file, "-o", FOLDER / folder)
        assert done.returncode == 0, done.stderr
    return file


class Commands(unittest.TestCase):
    def test_convert(self):
        there = FOLDER / "track.gpx"
        result = schuler.convert(drive() / "reference.csv", there)
        self.assertEqual([str(f) for f in result.files], [str(there)])
        self.assertIn("<gpx", there.read_text()[:200])
        with self.assertRaisesRegex(schuler.Error, "another name"):
            schuler.convert(there, there)
        there.write_text("mine")
        with self.assertRaisesRegex(schuler.Error, "exists"):
            schuler.convert(drive() / "reference.csv", there)
        schuler.convert(drive() / "reference.csv", there, force=True)
        self.assertIn("<gpx", there.read_text()[:200])

    def test_gnss(self):
        made("rinex", CAR, "rinex")
        result = schuler.gnss(FOLDER / "rinex", output=FOLDER / "rinex-out")
        self.assertTrue(result.usable)
        self.assertGreater(result.summary["epochs"] if isinstance(result.summary.get("epochs"), int) else len(result.summary), 0)
        self.assertTrue((FOLDER / "rinex-out/satellites.csv").is_file())

    def test_demo(self):
        result = schuler.demo(output=FOLDER / "demo")
        self.assertTrue(result.usable)
        self.assertTrue((FOLDER / "demo/summary.json").is_file())
        self.assertTrue((FOLDER / "demo/dataset/imu.csv").is_file())


class Studies(unittest.TestCase):
    ARGUMENTS = {"equator": {"speed": 600, "height": 10000, "dh": 1}, "schuler": {"tilt_east": 1e-3, "time": 600}, "observability": {"scenario": "car"}, "requirements": {},
                 "budget": {"scenario": "car", "runs": 2}, "covariance": {"scenario": "car", "settings": {"filter.scheme": "tight"}}, "integrity": {"scenario": "car", "runs": 2}, "triad": {"runs": 1},
                 "allan": {"input": "dataset"}, "protection": {"runs": 2}}

    def test_every_one(self):
        places = {"car": made("study", CAR.replace("rinex = true", "") + FILTER), "dataset": drive()}
        self.assertEqual(set(schuler.analyze.__all__), set(self.ARGUMENTS), "a study without a call here")
        for name in schuler.analyze.__all__:
            with self.subTest(name):
                arguments = {key: places.get(value, value) if isinstance(value, str) else value for key, value in self.ARGUMENTS[name].items()}
                result = getattr(schuler.analyze, name)(**arguments)
                self.assertIsInstance(result, schuler.Result)
                self.assertTrue(result.summary, "no numbers")
                with self.assertRaisesRegex(schuler.Error, "unknown keyword"):
                    getattr(schuler.analyze, name)(**arguments, nonsense=1)


def members():
    """(name, thing) of everything public: functions, classes, their methods and properties, studies."""
    for name in schuler.__all__:
        thing = getattr(schuler, name)
        if inspect.ismodule(thing):
            yield from ((f"{name}.{study}", getattr(thing, study)) for study in thing.__all__)
            continue
        yield name, thing
        if inspect.isclass(thing) and not issubclass(thing, Exception):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)) and not member.isupper():
                    yield f"{name}.{member}", value


class Documentation(unittest.TestCase):
    # words of pybind's enumerations; members of plain settings whose units stand in the text of their class
    WITHOUT = re.compile(r"^(EventKind|FeedStatus|Phase|Source)\.|Settings\.|^NavigatorState\.|^Mekf\.")
    UNITS = re.compile(r"\b(rad|deg|m|s|ns|T|Pa|Hz|m/s|m/s\^2|rad/s|dB-Hz|unit|units|SI)\b|scalar first|radians|dict|list|bytes|text|frame|None|schuler\.\w+|pandas")

    def test_every_public_name_has_a_docstring(self):
        self.assertGreater(len(list(members())), 100)
        for name, thing in members():
            if name == "__version__" or self.WITHOUT.search(name):
                continue
            with self.subTest(name):
                text = inspect.getdoc(thing) or ""
                self.assertGreater(len(text), 15, "no docstring")

    def test_units_and_shapes(self):
        """What takes or gives arrays says their units, and, where it takes several at once, their shapes."""
        for name in ("attitude", "Navigator.feed_imu", "Navigator.feed_gnss", "Navigator.feed_baro", "Navigator.feed_mag", "Navigator.feed_odometer", "Navigator.feed_heading",
                     "Navigator.feed_gauges", "Navigator.feed_body_velocity", "Navigator.feed_ranges", "Navigator.state", "Navigator.sensor_errors"):
            thing = schuler
            for part in name.split("."):
                thing = getattr(thing, part)
            with self.subTest(name):
                text = inspect.getdoc(thing)
                self.assertRegex(text, self.UNITS)
                if name.startswith("Navigator.feed_") or name == "attitude":
                    self.assertRegex(text, r"\(n,|\(3,\)|arrays of n")
        for name in ("dcm_from_rpy", "ecef_from_geodetic", "gravity_vector", "radii", "ned_difference", "moved_by_ned", "geodetic_from_ecef", "C_en"):
            with self.subTest(name):
                self.assertRegex(inspect.getdoc(getattr(schuler, name)), r"\brad\b|\bm\b|\(\.\.\.")

    def test_help_shows_the_feeds(self):
        out = io.StringIO()
        pydoc.Helper(output=out)(schuler.Navigator)
        text = re.sub(".\b", "", out.getvalue())
        for name in ("feed_imu(self, time, gyro, accel)", "feed_gauges(self, time, height)", "feed_body_velocity(self, time, velocity)", "feed_odometer(self, time, speed, std=None)",
                     "feed_heading(self, time, heading, std=None)", "feed_ranges(self, time, names"):
            self.assertIn(name, text)
        self.assertIn("m, up positive", text)


if __name__ == "__main__":
    main()

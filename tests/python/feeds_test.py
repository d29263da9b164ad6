"""Every feed of the navigator: a block and single samples, the recording and its arrays give the same bits; each makes the solution better."""
import unittest

from support import FOLDER, main, program

import numpy as np
import schuler

S = schuler.FeedStatus

SCENARIO = """name = "all"
duration_s = 40
[trajectory]
type = "car"
start = { lat_deg = 48, lon_deg = 11, height_m = 500 }
standstill_s = 15
[imu]
rate_hz = 50
grade = "tactical"
[gnss]
rate_hz = 1
[baro]
rate_hz = 2
[mag]
rate_hz = 5
[gauges]
rate_hz = 2
lever_arms_m = [[0, 0, 1], [2, 0, 1]]
[log]
rate_hz = 2
[compass]
rate_hz = 1
"""


def static_imu(seconds, latitude, height, rate=50):
    """Times, rates and forces of a body at rest, level, nose to the north; without errors."""
    time = np.arange(1, seconds * rate + 1) / rate
    turn = 7.292115e-5 * np.array([np.cos(latitude), 0.0, -np.sin(latitude)])
    force = -schuler.gravity_vector([latitude, 0.0, height])
    return time, np.tile(turn, (len(time), 1)), np.tile(force, (len(time), 1))


class EveryInstrument(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        (FOLDER / "all.toml").write_text(SCENARIO)
        done = program("simulate", FOLDER / "all.toml", "-o", FOLDER / "all")
        assert done.returncode == 0, done.stderr
        truth = schuler.open(FOLDER / "all").reference
        with open(FOLDER / "all/odometer.csv", "w") as file:
            file.write("time_s,speed_m_s,std_m_s\n")
            file.writelines(f"{t * 1e-9:.3f},{np.linalg.norm(v):.6f},0.05\n" for t, v in zip(truth.time_ns, truth.velocity))
        described = (FOLDER / "all/dataset.toml").read_text()
        assert described.count("[odometer]\n") == 1
        (FOLDER / "all/dataset.toml").write_text(described.replace("[odometer]\n", '[odometer]\nfile = "odometer.csv"\n'))
        cls.recording = schuler.open(FOLDER / "all")
        cls.rates = {"baro": 20, "mag": 20, "odometer": 20, "heading": 20, "gauges": 20, "gauge_count": 2, "body_velocity": 20}

    def navigator(self):
        return schuler.Navigator(self.recording.stream_settings(), imu_interval=0.02, rates=self.rates)

    def calls(self, n):
        """(table, feed of samples i to j) of each instrument, in the order in which a recording is fed."""
        r = self.recording
        return [(r.gnss, lambda t, s: n.feed_gnss(t, r.gnss.position[s], r.gnss.velocity[s], r.gnss.std_position[s], r.gnss.std_velocity[s])),
                (r.baro, lambda t, s: n.feed_baro(t, r.baro.height[s])), (r.mag, lambda t, s: n.feed_mag(t, r.mag.field[s])),
                (r.odometer, lambda t, s: n.feed_odometer(t, r.odometer.speed[s], r.odometer.std[s])),
                (r.heading, lambda t, s: n.feed_heading(t, r.heading.heading[s], r.heading.std[s])),
                (r.gauges, lambda t, s: n.feed_gauges(t, r.gauges.height[s])), (r.body_velocity, lambda t, s: n.feed_body_velocity(t, r.body_velocity.velocity[s]))]

    def test_the_recording_holds_them(self):
        r = self.recording
        self.assertEqual([len(t) > 10 for t in (r.imu, r.gnss, r.baro, r.mag, r.odometer, r.heading, r.gauges, r.body_velocity)], [True] * 8)

    def test_single_samples_and_blocks_are_taken(self):
        n, r = self.navigator(), self.recording
        n.feed_imu(r.imu.time_ns[:1], r.imu.gyro[:1], r.imu.accel[:1])
        for table, feed in self.calls(n):
            with self.subTest(table.name):
                status = feed(table.time_ns[0], 0)
                self.assertIsInstance(status, S)
                self.assertIn(status, (S.TAKEN, S.LATE))
                self.assertEqual(feed(table.time_ns[0], 0), status if status == S.LATE else S.DUPLICATE)
                statuses = feed(table.time_ns[1:4], slice(1, 4))
                self.assertEqual((statuses.dtype, statuses.shape), (np.uint8, (3,)))
        self.assertGreater(n.counters()["gauges"]["taken"], 0)
        self.assertGreater(n.counters()["body_velocity"]["taken"], 0)

    def test_arrays_equal_the_recording(self):
        whole, arrays, r = self.navigator(), self.navigator(), self.recording
        taken = whole.feed(r)
        for name in ("imu", "gnss", "baro", "mag", "odometer", "heading", "gauges", "body_velocity"):
            self.assertGreater(taken.get(name, 0), 10, f"{name}: {taken}")
        calls, next_of = self.calls(arrays), [0] * 7
        for i in range(len(r.imu)):
            for k, (table, feed) in enumerate(calls):
                while next_of[k] < len(table) and table.time_ns[next_of[k]] <= r.imu.time_ns[i]:
                    feed(table.time_ns[next_of[k]], next_of[k])
                    next_of[k] += 1
            arrays.feed_imu(r.imu.time_ns[i], r.imu.gyro[i], r.imu.accel[i])
        self.assertEqual(whole.phase, schuler.Phase.NAVIGATING)
        np.testing.assert_array_equal(whole.state().covariance, arrays.state().covariance)
        np.testing.assert_array_equal(whole.state().position, arrays.state().position)

    def test_wrong_shapes_and_values(self):
        n = self.navigator()
        n.feed_imu(0.0, [0, 0, 0], [0, 0, -9.8])
        for call, words in ((lambda: n.feed_gauges(0.0, [1, 2]), "height"), (lambda: n.feed_body_velocity([0.0, 1.0], np.zeros((3, 3))), "velocity: has 3 rows"),
                            (lambda: n.feed_odometer("now", 1.0), "time"), (lambda: n.feed_heading([0.0, 1.0], [0.1]), "heading"), (lambda: n.feed_mag(0.0, 1.0), "field")):
            with self.assertRaisesRegex(schuler.Error, words):
                call()
        for status in (n.feed_odometer(0.0, np.nan), n.feed_heading(0.0, np.inf), n.feed_gauges(0.0, [np.nan] * 3), n.feed_body_velocity(0.0, [np.nan, 0, 0])):
            self.assertEqual(status, S.BAD_VALUE)
        plain = schuler.Navigator(self.recording.stream_settings(), imu_interval=0.02)
        plain.feed_imu(0.0, [0, 0, 0], [0, 0, -9.8])
        for status in (plain.feed_odometer(0.0, 1.0), plain.feed_heading(0.0, 0.1), plain.feed_gauges(0.0, [1, 2, np.nan]), plain.feed_body_velocity(0.0, [1, 0, 0])):
            self.assertEqual(status, S.NOT_USED)


class Ranges(unittest.TestCase):
    """A body at rest and six transmitters that rest: the clock of the receiver is 100 m wrong."""
    PLACE = np.array([np.radians(48.0), 0.0, 500.0])
    DIRECTIONS = np.array([[0, 0, -1], [.8, 0, -.6], [-.6, .5, -.6], [-.3, -.8, -.5], [.5, .7, -.5], [.4, -.8, -.45]])

    def navigator(self, **more):
        zero = {f"initial.{key}": 0.0 for key in ("time_s", "lon_deg", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg")}
        sigma = {f"initial.std_{key}": value for key, value in {"n_m": 20, "e_m": 20, "d_m": 20, "vn_m_s": .1, "ve_m_s": .1, "vd_m_s": .1, "roll_deg": .05, "pitch_deg": .05,
                                                                "heading_deg": .5}.items()}
        settings = {"filter.scheme": "tight", "imu.grade": "tactical", "vehicle.kind": "air", "initial.lat_deg": 48.0, "initial.height_m": 510.0, "gnss.troposphere": "none",
                    "gnss.ionosphere": "none", **zero, **sigma, **more}
        return schuler.Navigator(settings, imu_interval=0.02, rates={"ranges": 2})

    def columns(self):
        here = schuler.ecef_from_geodetic(self.PLACE)
        up = self.DIRECTIONS / np.linalg.norm(self.DIRECTIONS, axis=1, keepdims=True)
        tx = here + 2.2e7 * up @ schuler.C_en(self.PLACE[0], self.PLACE[1]).T
        distance = np.linalg.norm(tx - here, axis=1)
        # the Earth turns while the signal is on its way
        angle = 7.292115e-5 * distance / 299792458.0
        turned = np.column_stack([np.cos(angle) * tx[:, 0] + np.sin(angle) * tx[:, 1], np.cos(angle) * tx[:, 1] - np.sin(angle) * tx[:, 0], tx[:, 2]])
        return {"pseudorange": np.linalg.norm(turned - here, axis=1) + 100.0, "std": np.ones(6), "tx": tx, "tx_velocity": np.zeros((6, 3)), "cn0": np.full(6, 45.0)}

    def test_they_find_the_place(self):
        n, columns, names = self.navigator(), self.columns(), [f"G{i:02d}" for i in range(1, 7)]
        time, gyro, accel = static_imu(20, self.PLACE[0], self.PLACE[2])
        for second in range(20):
            part = slice(50 * second, 50 * (second + 1))
            n.feed_imu(time[part], gyro[part], accel[part])
            self.assertEqual(n.feed_ranges(float(second + 1), names, **columns), S.TAKEN)
        n.feed_imu(time[-1] + 0.02, gyro[0], accel[0])
        state = n.state()
        off = schuler.ned_difference(state.position, self.PLACE)
        self.assertLess(np.linalg.norm(off[:2]), 2.0, f"{off}")
        self.assertLess(abs(off[2]), 4.0, f"it began 10 m too high: {off}")
        self.assertLess(state.covariance[0, 0], 2.0 ** 2)
        self.assertEqual(n.counters()["ranges"]["taken"], 20)

    def test_wrong_calls(self):
        n, columns, names = self.navigator(), self.columns(), [f"G{i:02d}" for i in range(1, 7)]
        time, gyro, accel = static_imu(1, self.PLACE[0], self.PLACE[2])
        n.feed_imu(time, gyro, accel)
        for call, words in ((lambda: n.feed_ranges(1.0, names, pseudo=columns["std"]), "unknown keyword"), (lambda: n.feed_ranges([1.0, 2.0], names, **columns), "one epoch"),
                            (lambda: n.feed_ranges(1.0, names[:5], **columns), "pseudorange|rows"), (lambda: n.feed_ranges(1.0, names, station=[True], **columns), "another length")):
            with self.assertRaisesRegex(schuler.Error, words):
                call()
        self.assertEqual(n.feed_ranges(1.0, names, **{**columns, "pseudorange": np.full(6, np.inf)}), S.BAD_VALUE)
        loose = schuler.Navigator({"imu.grade": "tactical"}, imu_interval=0.02)
        loose.feed_imu(time, gyro, accel)
        self.assertEqual(loose.feed_ranges(1.0, names, **columns), S.NOT_USED)


if __name__ == "__main__":
    main()

"""The navigator: blocks equal single samples, recordings equal arrays, its solution that of the program, nothing of a user ignored."""
import unittest

from support import drive, main

import numpy as np
import schuler

S = schuler.FeedStatus


class Fed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recording = schuler.open(drive())
        cls.settings = cls.recording.stream_settings()
        cls.options = {"imu_interval": 0.01, "rates": {"baro": 20}}

    def navigator(self):
        return schuler.Navigator(self.settings, **self.options)

    def blocks(self, navigator, seconds):
        """The recording in blocks that are shorter than the lag."""
        r, statuses = self.recording, []
        begin, end = r.imu.time_ns[0], r.imu.time_ns[-1]
        for t in range(begin, end + 1, int(seconds * 1e9)):
            part = [slice(*np.searchsorted(table.time_ns, [t, t + int(seconds * 1e9)])) for table in (r.gnss, r.baro, r.imu)]
            g, b, i = part
            if t == begin:
                g, b = slice(0, g.stop), slice(0, b.stop)
            navigator.feed_gnss(r.gnss.time_ns[g], r.gnss.position[g], r.gnss.velocity[g], r.gnss.std_position[g], r.gnss.std_velocity[g])
            navigator.feed_baro(r.baro.time_ns[b], r.baro.height[b])
            statuses.append(navigator.feed_imu(r.imu.time_ns[i], r.imu.gyro[i], r.imu.accel[i]))
        return np.concatenate(statuses)

    def test_blocks_equal_single_samples_and_the_recording(self):
        whole, block, single = self.navigator(), self.navigator(), self.navigator()
        taken = whole.feed(self.recording)
        self.assertEqual(taken["imu"], len(self.recording.imu))
        self.assertTrue(np.all(self.blocks(block, 0.4) == int(S.TAKEN)))
        r, g, b = self.recording, 0, 0
        for i in range(len(r.imu)):
            while g < len(r.gnss) and r.gnss.time_ns[g] <= r.imu.time_ns[i]:
                single.feed_gnss(r.gnss.time_ns[g], r.gnss.position[g], r.gnss.velocity[g], r.gnss.std_position[g], r.gnss.std_velocity[g])
                g += 1
            while b < len(r.baro) and r.baro.time_ns[b] <= r.imu.time_ns[i]:
                single.feed_baro(r.baro.time_ns[b], r.baro.height[b])
                b += 1
            self.assertEqual(single.feed_imu(r.imu.time_ns[i], r.imu.gyro[i], r.imu.accel[i]), S.TAKEN)
        self.assertEqual(whole.phase, schuler.Phase.NAVIGATING)
        a, *others = (n.rows() for n in (whole, block, single))
        self.assertGreater(len(a), 500)
        for other in others:
            for name in a:
                np.testing.assert_array_equal(a[name], other[name])
        np.testing.assert_array_equal(whole.state().covariance, single.state().covariance)

    def test_it_finds_the_truth(self):
        n = self.navigator()
        n.feed(self.recording)
        state, truth = n.state(), self.recording.reference
        off = schuler.ned_difference(state.position, truth.position[-1])
        sigma = np.sqrt(np.diag(state.covariance))
        self.assertTrue(np.all(np.abs(off) < 5 * sigma[:3]), f"{off} of {sigma[:3]}")
        heading = schuler.wrap_pi(state.rpy[2] - truth.rpy[-1, 2])
        self.assertLess(abs(heading), 5 * sigma[8])
        np.testing.assert_allclose(schuler.quaternion_from_rpy(state.rpy) * np.sign(state.q_nb[0]),
                                   state.q_nb * np.sign(schuler.quaternion_from_rpy(state.rpy)[0]), atol=1e-12)
        solution = schuler.process(drive(), self_check=False).solution.si()
        rows = n.rows()
        at = np.searchsorted(solution.time_ns, rows.time_ns[-1])
        apart = schuler.ned_difference(rows.position[-1], solution.position[min(at, len(solution) - 1)])
        self.assertLess(np.linalg.norm(apart), 1.0)
        self.assertEqual(n.sensor_errors()["gyro_bias"].shape, (3,))
        kinds = [e["kind"] for e in n.events()]
        self.assertIn(schuler.EventKind.PHASE, kinds)
        self.assertEqual(len(n.rows()), 0, "they are fetched once")

    def test_save_and_restore(self):
        r, half = self.recording, 6000
        first = self.navigator()
        first.feed_gnss(r.gnss.time_ns[0], r.gnss.position[0], r.gnss.velocity[0], r.gnss.std_position[0], r.gnss.std_velocity[0])
        first.feed_imu(r.imu.time_ns[:half], r.imu.gyro[:half], r.imu.accel[:half])
        second = self.navigator()
        second.restore(first.save())
        for n in (first, second):
            n.rows()
            n.feed_imu(r.imu.time_ns[half:half + 500], r.imu.gyro[half:half + 500], r.imu.accel[half:half + 500])
        self.assertEqual(first.save(), second.save())
        with self.assertRaisesRegex(schuler.Error, "damaged|nothing|short"):
            second.restore(b"x" * 1000)
        with self.assertRaisesRegex(schuler.Error, "other settings|short"):
            schuler.Navigator({"imu.grade": "mems"}).restore(first.save())

    def test_no_copies(self):
        imu = self.recording.imu
        self.assertFalse(imu.gyro.flags.owndata)
        self.assertFalse(imu.gyro.flags.writeable)
        self.assertEqual(imu.accel.ctypes.data - imu.gyro.ctypes.data, 24)
        outlives = schuler.open(drive()).imu.gyro   # its recording
        np.testing.assert_array_equal(outlives, imu.gyro)
        backwards = np.ascontiguousarray(imu.gyro[::-1])[::-1]   # negative strides are read where they lie
        a, b = schuler.Navigator(self.settings), schuler.Navigator(self.settings)
        np.testing.assert_array_equal(a.feed_imu(imu.time_ns, imu.gyro, imu.accel), b.feed_imu(imu.time_ns, backwards, imu.accel.tolist()))
        self.assertEqual(a.save(), b.save())

    def test_seconds_and_nanoseconds(self):
        imu, a, b = self.recording.imu, schuler.Navigator(self.settings), schuler.Navigator(self.settings)
        a.feed_imu(imu.time_ns[:300], imu.gyro[:300], imu.accel[:300])
        b.feed_imu(imu.time_ns[:300] * 1e-9, imu.gyro[:300], imu.accel[:300])
        self.assertEqual(a.save(), b.save())

    def test_bad_samples_are_refused_by_status(self):
        n, imu = self.navigator(), self.recording.imu
        self.assertEqual(n.feed_imu(0.0, [np.nan, 0, 0], [0, 0, 0]), S.BAD_VALUE)
        self.assertEqual(n.feed_imu(0.0, imu.gyro[0], imu.accel[0]), S.TAKEN)
        self.assertEqual(n.feed_imu(0.0, imu.gyro[0], imu.accel[0]), S.DUPLICATE)
        self.assertEqual(n.feed_mag(0.0, [2e-5, 0, 4e-5]), S.NOT_USED)
        self.assertEqual(n.counters()["imu"]["bad_value"], 1)

    def test_wrong_calls(self):
        n = self.navigator()
        for call, words in ((lambda: n.feed_imu([0.0, 0.1], np.zeros((3, 3)), np.zeros((2, 3))), "gyro: has 3 rows"),
                            (lambda: n.feed_imu([0.0], np.zeros((1, 2)), np.zeros((1, 3))), r"gyro: has the shape \(1, 2\)"),
                            (lambda: n.feed_imu(["a"], np.zeros((1, 3)), np.zeros((1, 3))), "time"),
                            (lambda: n.feed_imu([np.inf], np.zeros((1, 3)), np.zeros((1, 3))), "not finite"),
                            (lambda: n.feed_gnss(0.0, [0, 0, 0], fix="good"), "fix"),
                            (lambda: schuler.Navigator({"imu.grad": "mems"}), "imu.grade"),
                            (lambda: schuler.Navigator({"imu.file": "x.csv"}), "no meaning"),
                            (lambda: schuler.Navigator({"filter.smooth": True}), "filter.smooth"),
                            (lambda: schuler.Navigator({"gnss.latency_s": "estimate"}), "latency"),
                            (lambda: schuler.Navigator({"filter.scheme": "deep"}, rates={"ranges": 10}), "filter.scheme"),
                            (lambda: schuler.Navigator(imu_interval=-1), "imu_interval"),
                            (lambda: schuler.Navigator(rates={"barro": 1}), "did you mean baro")):
            with self.assertRaisesRegex(schuler.Error, words):
                call()


if __name__ == "__main__":
    main()

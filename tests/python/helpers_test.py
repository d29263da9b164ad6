"""Attitude, geodesy, time and the attitude filter: against closed forms and each other."""
import unittest

from support import drive, main

import numpy as np
import schuler

RANDOM = np.random.default_rng(1)
RPY = np.column_stack([RANDOM.uniform(-3, 3, 50), RANDOM.uniform(-1.5, 1.5, 50), RANDOM.uniform(0, 6.28, 50)])


class Attitude(unittest.TestCase):
    def test_round_trips(self):
        C = schuler.dcm_from_rpy(RPY)
        self.assertEqual(C.shape, (50, 3, 3))
        np.testing.assert_allclose(schuler.rpy_from_dcm(C), RPY, atol=1e-12)
        q = schuler.quaternion_from_rpy(RPY)
        np.testing.assert_allclose(schuler.rpy_from_quaternion(q), RPY, atol=1e-12)
        np.testing.assert_allclose(schuler.dcm_from_quaternion(q), C, atol=1e-14)
        np.testing.assert_allclose(np.abs(np.sum(schuler.quaternion_from_dcm(C) * q, axis=1)), 1.0, atol=1e-14)
        r = schuler.rotation_vector_from_quaternion(q)
        np.testing.assert_allclose(schuler.dcm_from_rotation_vector(r), C, atol=1e-13)
        self.assertEqual(schuler.dcm_from_rpy(RPY.reshape(5, 10, 3)).shape, (5, 10, 3, 3))

    def test_what_they_mean(self):
        nose_up = schuler.dcm_from_rpy([0.0, np.radians(30), np.radians(90)])
        np.testing.assert_allclose(nose_up @ [1, 0, 0], [0, np.cos(np.radians(30)), -0.5], atol=1e-15)
        np.testing.assert_allclose(schuler.skew([1, 2, 3]) @ [4, 5, 6], np.cross([1, 2, 3], [4, 5, 6]))
        np.testing.assert_allclose(schuler.wrap_pi([3 * np.pi, -0.5]), [np.pi, -0.5])
        np.testing.assert_allclose(schuler.wrap_2pi(-0.5), 2 * np.pi - 0.5)
        with self.assertRaisesRegex(schuler.Error, r"rpy: has the shape \(2,\)"):
            schuler.dcm_from_rpy([1, 2])


class Geodesy(unittest.TestCase):
    def test_positions(self):
        p = np.column_stack([RANDOM.uniform(-1.5, 1.5, 20), RANDOM.uniform(-3.1, 3.1, 20), RANDOM.uniform(-100, 2e4, 20)])
        r = schuler.ecef_from_geodetic(p)
        a, e2 = 6378137.0, (2 - 1 / 298.257223563) / 298.257223563
        n = a / np.sqrt(1 - e2 * np.sin(p[:, 0]) ** 2)
        np.testing.assert_allclose(r[:, 2], (n * (1 - e2) + p[:, 2]) * np.sin(p[:, 0]), atol=1e-8)
        np.testing.assert_allclose(schuler.geodetic_from_ecef(r), p, atol=1e-8)
        moved = schuler.moved_by_ned(p, [10.0, -20.0, 5.0])
        np.testing.assert_allclose(schuler.ned_difference(moved, p), np.tile([10, -20, 5], (20, 1)), atol=1e-6)
        self.assertEqual(schuler.ecef_from_geodetic(p[0]).shape, (3,))
        np.testing.assert_allclose(schuler.radii(p[:, 0])[:, 1], n, rtol=1e-14)
        self.assertAlmostEqual(schuler.gravity_vector([np.pi / 4, 0, 0])[2], 9.8061977, places=6)
        there = schuler.datum_changed(p, "wgs84", "sk42")
        self.assertGreater(np.abs(there[:, :2] - p[:, :2]).max() * a, 50)
        np.testing.assert_allclose(schuler.datum_changed(there, "sk42", "wgs84"), p, atol=1e-8)
        with self.assertRaisesRegex(schuler.Error, "ellipsoid"):
            schuler.ecef_from_geodetic(p, "flat")

    def test_time(self):
        gps = schuler.gps_from_utc(2020, 1, 1)
        self.assertEqual(gps, schuler.gps_from_week(2086, 3 * 86400 + 18))
        self.assertEqual(schuler.utc_from_gps(gps), (2020, 1, 1, 0, 0, 0.0))


class Ahrs(unittest.TestCase):
    def test_block_equals_single_samples_and_whole_log(self):
        n, dt = 4000, 0.01
        rpy = np.column_stack([0.3 * np.sin(np.arange(n) * dt), 0.1 * np.cos(np.arange(n) * dt), 0.2 * np.arange(n) * dt])
        C = schuler.dcm_from_rpy(rpy)
        turn = schuler.rotation_vector_from_quaternion(schuler.quaternion_from_dcm(np.swapaxes(C[:-1], 1, 2) @ C[1:]))
        gyro = np.vstack([turn[:1], turn]) / dt
        accel = np.einsum("nij,i->nj", C, [0, 0, -9.81])
        mag = np.einsum("nij,i->nj", C, [2e-5, 0, 4e-5])
        mag[np.arange(n) % 4 != 0] = np.nan
        block, single = schuler.Mekf(), schuler.Mekf()
        q = block.feed(dt, gyro, accel, mag)
        ones = np.array([single.feed(dt, gyro[i], accel[i], None if np.isnan(mag[i, 0]) else mag[i]) for i in range(n)])
        np.testing.assert_array_equal(q, ones)
        error = schuler.rotation_vector_from_quaternion(schuler.quaternion_from_dcm(np.swapaxes(schuler.dcm_from_quaternion(q[-1:]), 1, 2) @ C[-1:]))
        self.assertLess(np.abs(error).max(), np.radians(2.0))
        self.assertEqual(block.covariance.shape, (3, 3))
        time = np.arange(1, n + 1) * dt
        there = ~np.isnan(mag[:, 0])
        rows = schuler.attitude(time, gyro, accel, mag=mag[there], mag_time=time[there])
        np.testing.assert_allclose(rows.q_nb[-1], q[-1], atol=1e-3)
        with self.assertRaisesRegex(schuler.Error, "dt"):
            block.feed(0.0, gyro, accel)
        settings = schuler.MekfSettings()
        settings.tilt.bias_std = -1
        with self.assertRaisesRegex(schuler.Error, "bias_std|bias"):
            schuler.Mekf(settings)


class Recordings(unittest.TestCase):
    def test_opened(self):
        recording = schuler.open(drive())
        self.assertEqual(recording.imu_kind, "increments")
        self.assertEqual(recording.imu.units["gyro"], "rad")
        self.assertEqual(recording.gnss.fix[0], "rtk_fixed")
        self.assertEqual(recording.settings["imu.grade"], "tactical")
        self.assertEqual(len(recording.mag), 0)
        self.assertEqual(recording.mag.field.shape, (0, 3))
        with self.assertRaisesRegex(schuler.Error, "no such file"):
            schuler.open("nowhere")


if __name__ == "__main__":
    main()

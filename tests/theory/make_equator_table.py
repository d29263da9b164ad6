#!/usr/bin/env python3
"""Writes the tables beside it: paper C's flight along the equator with 40 digits.

    make_equator_table.py          needs mpmath (Debian: python3-mpmath); takes some seconds

equator_table.csv: speed, height, t and the 36 elements of the transition matrix. equator_forced.csv: speed, height, longitude, t,
the nine lambda_ij and the six errors that a misaligned start forces, (23).

Independent of the closed form: the matrix A of (10) is built from its definition and exponentiated by scaling and a Taylor series
in 60-digit arithmetic; the forcing of (8) is harmonic, so that an oscillator at w_n and one at 2 w_n beside A carry it. The
inputs are the doubles that the tests use. Some speeds undo the Earth's rotation, where the printed solution divides by zero;
some are beyond the limiting speeds.
"""
import csv
from pathlib import Path

from mpmath import cos, eye, matrix, mp, mpf, nstr, sin, zeros

mp.dps = 60
U, A, G = mpf(7.29e-5), mpf(6378245.0), mpf(9.78049)
FLIGHTS = [(600.0, 10000.0), (10.0, 0.0), (0.0, 0.0), (-300.0, 5000.0), (2000.0, 20000.0), (7000.0, 0.0), (-7000.0, 100000.0),
           (-465.0, 0.0), (-464.974, 0.0), (-464.9740605, 0.0), (-7.29e-5 * 6378245.0, 0.0), (7600.0, 0.0), (-8500.0, 0.0)]
TIMES = [1.0, 600.0, 3600.0, 7200.0]
GENERAL = [[1e-6, 1e-5, -2e-5], [3e-6, -4e-6, 5e-6], [-7e-6, 8e-6, 9e-6]]
FORCED = [(600.0, 10000.0, 0.7, 3600.0), (-465.0, 0.0, 2.0, 3600.0), (7433.37, 0.0, -1.0, 1800.0)]


def dynamics(speed, height):
    v, R = mpf(speed), A + mpf(height)
    g = G * A**2 / R**2
    wn, ah = U + v / R, g - 2 * U * v - v**2 / R
    m = zeros(6)
    m[0, 4] = -g
    m[1, 2], m[1, 3] = 2 * wn, 2 * g / R - (v / R) ** 2
    m[2, 1], m[2, 5] = -(2 * U + v / R), -ah
    m[3, 1] = 1
    m[4, 0] = 1 / R
    m[5, 2], m[5, 3] = 1 / R, -v / R**2
    return m, wn, ah


def exponential(m, t):
    squarings = 12
    step = m * (mpf(t) / 2**squarings)
    term, total = eye(m.rows), eye(m.rows)
    for k in range(1, 60):
        term = term * step / k
        total = total + term
    for _ in range(squarings):
        total = total * total
    return total


def forced(speed, height, l, longitude, t):
    m, wn, ah = dynamics(speed, height)
    # States 6 to 10: 1, cos x, sin x, cos 2x, sin 2x with x = longitude + w_n tau.
    big = zeros(11)
    big[0:6, 0:6] = m
    big[7, 8], big[8, 7], big[9, 10], big[10, 9] = -wn, wn, -2 * wn, 2 * wn
    half = mpf(1) / 2
    big[0, 7], big[0, 8] = ah * l[0][1], ah * l[0][2]
    big[1, 6], big[1, 9], big[1, 10] = (ah * half * (l[1][1] + l[2][2]), ah * half * (l[1][1] - l[2][2]),
                                        ah * half * (l[2][1] + l[1][2]))
    big[2, 6], big[2, 9], big[2, 10] = (ah * half * (l[2][1] - l[1][2]), ah * half * (l[2][1] + l[1][2]),
                                        ah * half * (l[2][2] - l[1][1]))
    start = matrix([0] * 6 + [1, cos(longitude), sin(longitude), cos(2 * longitude), sin(2 * longitude)])
    return (exponential(big, t) * start)[0:6]


def digits(x):
    return nstr(x, 40) if x else "0"


def main():
    folder = Path(__file__).resolve().parent
    with open(folder / "equator_table.csv", "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        for speed, height in FLIGHTS:
            m, _, _ = dynamics(speed, height)
            for t in TIMES:
                p = exponential(m, t)
                table.writerow([repr(speed), repr(height), repr(t)] + [digits(p[i, j]) for i in range(6) for j in range(6)])
    with open(folder / "equator_forced.csv", "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        exact = [[mpf(v) for v in row] for row in GENERAL]
        for speed, height, longitude, t in FORCED:
            x = forced(speed, height, exact, mpf(longitude), mpf(t))
            table.writerow([repr(v) for v in (speed, height, longitude, t)] + [repr(v) for row in GENERAL for v in row] +
                           [digits(v) for v in x])


if __name__ == "__main__":
    main()

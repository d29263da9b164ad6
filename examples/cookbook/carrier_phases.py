"""Gives a simulated RINEX file the phases of two carriers, for the cookbook: docs/cookbook.md.

    python3 examples/cookbook/carrier_phases.py IN.rnx OUT.rnx SEED

The file has exact ranges in C1C (a scenario with ranges.rinex and errors of nearly zero). Written are C1C and C2W with 0.3 m of noise and L1C
and L2W with 2 mm and an unknown whole number of cycles for each satellite and carrier: no ionosphere, no slips.
"""
import random
import sys

LIGHT = 299_792_458.0
CARRIERS = (("1C", 1575.42e6), ("2W", 1227.60e6))


def main():
    source, out, seed = sys.argv[1:4]
    draw = random.Random(int(seed))
    whole = {}
    with open(source) as lines, open(out, "w") as file:
        for line in lines:
            if line[60:].startswith("SYS / # / OBS TYPES"):
                line = f"{'G    5 C1C L1C C2W L2W D1C':60}SYS / # / OBS TYPES\n"
            elif line.startswith("G") and line[1:3].isdigit():
                satellite, exact, doppler = line[:3], float(line[3:17]), line[35:49]
                line = satellite
                for name, frequency in CARRIERS:
                    length = LIGHT / frequency
                    cycles = whole.setdefault((satellite, name), draw.randrange(-100_000, 100_000))
                    line += f"{exact + draw.gauss(0.0, 0.3):14.3f}  {exact / length + cycles + draw.gauss(0.0, 0.002) / length:14.3f}  "
                line = (line + doppler).rstrip() + "\n"
            file.write(line)


main()

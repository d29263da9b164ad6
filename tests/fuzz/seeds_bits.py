"""The invented elements of the binary seeds, and bits to write them with."""
from seeds_text import WEEK

TOW = 36000
# Angles in half turns, as satellites send them; lengths m, times s.
ORBIT = {"crs": 50.0, "delta_n": 1.5e-9, "m0": 0.125, "cuc": 1e-6, "e": 0.01, "cus": 8e-6, "sqrt_a": 5153.5, "cic": 1e-7,
         "omega0": 0.375, "cis": -1e-7, "i0": 0.3125, "crc": 250.0, "omega": -0.25, "omega_dot": -2.5e-9, "idot": 5e-11}
CLOCK = (1e-4, 1e-12, 0.0)
# Bits and exponents of two of GPS, QZSS and Galileo; e and sqrt_a carry no sign
SCALES = {"crs": (16, -5), "delta_n": (16, -43), "m0": (32, -31), "cuc": (16, -29), "e": (32, -33), "cus": (16, -29),
          "sqrt_a": (32, -19), "cic": (16, -29), "omega0": (32, -31), "cis": (16, -29), "i0": (32, -31), "crc": (16, -5),
          "omega": (32, -31), "omega_dot": (24, -43), "idot": (14, -43)}


class Bits:
    """Bits, most significant first, as text of 0 and 1."""

    def __init__(self):
        self.text = ""

    def put(self, value, count):
        """Two's complement where negative."""
        self.text += format(int(value) & ((1 << count) - 1), f"0{count}b")
        return self

    def scaled(self, value, count, exponent):
        return self.put(round(value / 2.0 ** exponent), count)

    def magnitude(self, value, count, exponent):
        """A sign and a magnitude, as GLONASS writes numbers."""
        return self.put(value < 0, 1).put(round(abs(value) / 2.0 ** exponent), count - 1)

    def orbit(self, *names):
        for name in names:
            self.scaled(ORBIT[name], *SCALES[name])
        return self

    def beidou(self, *names):
        """As GPS, but the harmonic corrections have two more bits."""
        for name in names:
            count, exponent = SCALES[name]
            finer = {"cuc": -31, "cus": -31, "cic": -31, "cis": -31, "crc": -6, "crs": -6}.get(name)
            self.scaled(ORBIT[name], *((18, finer) if finer else (count, exponent)))
        return self

    def bytes(self):
        padded = self.text + "0" * (-len(self.text) % 8)
        return bytes(int(padded[i:i + 8], 2) for i in range(0, len(padded), 8))


def crc24q(data):
    crc = 0
    for byte in data:
        crc ^= byte << 16
        for _ in range(8):
            crc = crc << 1 ^ 0x1864CFB if crc & 0x800000 else crc << 1
    return crc & 0xFFFFFF

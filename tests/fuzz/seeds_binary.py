"""Seeds of the binary readers: UBX and RTCM 3, encoded from the same invented elements as seeds_text.py, in round numbers."""
import struct

from seeds_text import WEEK

TOW = 36000
SPEED_OF_LIGHT = 299792458.0
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


# GPS: which data bits each parity bit sums, and which of the last two bits of the word before (IS-GPS-200, table 20-XIV)
PARITY = [(0, (1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23)), (1, (2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24)),
          (0, (1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22)), (1, (2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23)),
          (1, (1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24)), (0, (3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24))]


def parity(data, before):
    return "".join(str((int(before[which]) + sum(int(data[i - 1]) for i in bits)) % 2) for which, bits in PARITY)


def gps_words(bits):
    """Ten words of 24 data bits and parity; the last two data bits of words 2 and 10 are such that their parity ends in zeros."""
    words, before = [], "00"
    for i in range(10):
        data = bits.text[24 * i:24 * i + 24]
        if i in (1, 9):
            data = next(d for d in (data[:22] + t for t in ("00", "01", "10", "11")) if parity(d, before).endswith("00"))
        word = data + parity(data, before)
        before = word[-2:]
        words.append(int(word, 2))
    return words


def gps_subframe(number):
    b = Bits().put(0x8B, 8).put(0, 16).put((TOW + 6 * (number - 1)) // 6 + 1, 17).put(0, 2).put(number, 3).put(0, 2)
    if number == 1:
        b.put(WEEK, 10).put(1, 2).put(0, 4).put(0, 6).put(0, 2).put(0, 88).scaled(5e-9, 8, -31).put(11, 8).put(TOW // 16, 16)
        b.scaled(CLOCK[2], 8, -55).scaled(CLOCK[1], 16, -43).scaled(CLOCK[0], 22, -31).put(0, 2)
    elif number == 2:
        b.put(11, 8).orbit("crs", "delta_n", "m0", "cuc", "e", "cus", "sqrt_a").put(TOW // 16, 16).put(0, 8)
    elif number == 3:
        b.orbit("cic", "omega0", "cis", "i0", "crc", "omega", "omega_dot").put(11, 8).orbit("idot").put(0, 2)
    else:  # page 18 of subframe 4: ionosphere and leap seconds
        b.put(1, 2).put(56, 6)
        for value, exponent in zip((1e-8, 1e-8, -1e-7, 0.0, 1e5, 0.0, -1e5, 0.0), (-30, -27, -24, -24, 11, 14, 16, 16)):
            b.scaled(value, 8, exponent)
        b.put(0, 72).put(18, 8).put(0, 40)
    return gps_words(b)


def ubx(kind, payload):
    body = struct.pack("<HH", kind, len(payload)) + payload
    a = b = 0
    for byte in body:
        a = (a + byte) & 0xFF
        b = (b + a) & 0xFF
    return b"\xb5\x62" + body + bytes((a, b))


def ubx_subframe(gnss, number, words, signal=0, frequency=0):
    head = struct.pack("<8B", gnss, number, signal, frequency, len(words), 0, 2, 0)
    return ubx(0x1302, head + struct.pack(f"<{len(words)}I", *words))


def ubx_measurements(epoch):
    # u-blox numbers of system, satellite, signal, and GLONASS channel plus 7
    satellites = [(0, 3, 0, 0), (0, 3, 3, 0), (0, 12, 0, 0), (1, 120, 0, 0), (2, 11, 0, 0), (3, 21, 0, 0), (5, 2, 0, 0),
                  (6, 5, 0, 8)]
    blocks = b""
    for gnss, number, signal, channel in satellites:
        code = 20e6 + 1e5 * number + 100.0 * epoch
        blocks += struct.pack("<ddfBBBBHBBBBBB", code, 5 * code, -500.0, gnss, number, signal, channel, 1000 + 1000 * epoch, 45,
                              5, 5, 5, 7, 0)
    return ubx(0x1502, struct.pack("<dHbBBBH", TOW + epoch, WEEK, 18, len(satellites), 1, 1, 0) + blocks)


def ubx_fix():
    """30 N, 95 E, 100 m, in three dimensions with 12 satellites, at the first epoch (UTC is 18 s behind)."""
    time = struct.pack("<IHBBBBBBIiBBBB", TOW * 1000, 2023, 1, 8, 9, 59, 42, 7, 20, 0, 3, 1, 0, 12)
    place = struct.pack("<iiiiII", 950000000, 300000000, 100000, 80000, 1000, 2000)
    motion = struct.pack("<iiiiiIIHHIihH", 10, -20, 5, 22, 0, 100, 100000, 150, 0, 0, 0, 0, 0)
    return ubx(0x0701, time + place + motion)


def ubx_log():
    log = ubx_measurements(0) + ubx_fix() + b"$GPTXT,text between messages\r\n"
    for number in (1, 2, 3, 4):
        log += ubx_subframe(0, 3, gps_subframe(number))
    return log + ubx_measurements(1) + ubx(0x0D01, bytes(20))  # NAV-CLOCK-like: of another kind


def rtcm(bits):
    payload = bits.bytes()
    frame = b"\xd3" + struct.pack(">H", len(payload)) + payload
    return frame + crc24q(frame).to_bytes(3, "big")


FROM_CRS = ("crs", "delta_n", "m0", "cuc", "e", "cus", "sqrt_a")
FROM_CIC = ("cic", "omega0", "cis", "i0", "crc", "omega", "omega_dot")


def rtcm_gps():
    b = Bits().put(1019, 12).put(3, 6).put(WEEK, 10).put(0, 4).put(1, 2).orbit("idot").put(11, 8).put(TOW // 16, 16)
    b.scaled(CLOCK[2], 8, -55).scaled(CLOCK[1], 16, -43).scaled(CLOCK[0], 22, -31).put(11, 10).orbit(*FROM_CRS).put(TOW // 16, 16)
    return rtcm(b.orbit(*FROM_CIC).scaled(5e-9, 8, -31).put(0, 6).put(1, 1).put(0, 1))


def rtcm_galileo():
    b = Bits().put(1046, 12).put(11, 6).put(WEEK - 1024, 12).put(11, 10).put(107, 8).orbit("idot").put(TOW // 60, 14)
    b.scaled(CLOCK[2], 6, -59).scaled(CLOCK[1], 21, -46).scaled(CLOCK[0], 31, -34).orbit(*FROM_CRS).put(TOW // 60, 14)
    return rtcm(b.orbit(*FROM_CIC).scaled(5e-9, 10, -32).scaled(6e-9, 10, -32).put(0, 6).put(TOW, 20).put(0, 2))


def rtcm_glonass():
    """Reference 12:45 in Moscow, the 51st quarter of an hour."""
    b = Bits().put(1020, 12).put(5, 6).put(8, 5).put(0, 16).put(0, 2).put(51, 7)
    for x, v, a in ((10000.0, 1.0, 0.0), (-15000.0, 2.0, 1e-9), (18000.0, -2.0, -2e-9)):
        b.magnitude(v, 24, -20).magnitude(x, 27, -11).magnitude(a, 5, -30)
    b.put(0, 1).magnitude(1e-12, 11, -40).put(0, 3).magnitude(-1e-4, 22, -30).magnitude(2e-9, 5, -30).put(0, 5)
    return rtcm(b.put(0, 1 + 4 + 11 + 2 + 1 + 11 + 32 + 5 + 22 + 1 + 7))


def rtcm_msm(number, satellites, signals, time, more):
    """A multiple-signal message of type 4 or 7 in which every satellite has every signal (places in the mask, from 1)."""
    fine = number % 10 == 7
    b = Bits().put(number, 12).put(1, 12).put(time, 30).put(more, 1).put(0, 18)
    b.put(sum(1 << (64 - s) for s in satellites), 64).put(sum(1 << (32 - s) for s in signals), 32)
    cells = len(satellites) * len(signals)
    b.put(-1, cells)
    for s in satellites:
        b.put(70 + s, 8)
    if fine:
        for _ in satellites:
            b.put(8 if number // 10 == 108 else 0, 4)  # GLONASS: channel plus 7
    for _ in satellites:
        b.put(512, 10)
    if fine:
        for _ in satellites:
            b.put(100, 14)
    range_bits, phase_bits, lock_bits, strength_bits = (20, 24, 10, 10) if fine else (15, 22, 4, 6)
    for count, value in ((range_bits, 1000), (phase_bits, 2000), (lock_bits, 5), (1, 0), (strength_bits, 720 if fine else 45)):
        for _ in range(cells):
            b.put(value, count)
    if fine:
        for _ in range(cells):
            b.put(50, 15)
    return rtcm(b)


def rtcm_log():
    log = rtcm_gps() + rtcm_galileo() + b"text between frames\r\n" + rtcm_glonass()
    moscow = (TOW + 3 * 3600 - 18) * 1000
    for epoch in range(2):
        log += rtcm_msm(1074, (3, 12), (2, 10), (TOW + epoch) * 1000, 1) + rtcm_msm(1087, (5,), (2,), moscow + 1000 * epoch, 1)
        log += rtcm_msm(1097, (11,), (2, 23), (TOW + epoch) * 1000, 1) + rtcm_msm(1124, (21,), (2,), (TOW + epoch - 14) * 1000, 0)
    return log + rtcm(Bits().put(1005, 12).put(0, 140))


def seeds():
    """Name in corpus/receiver_logs, and bytes; the first chooses the reader of fuzz_receiver_logs.cpp (modulo 2)."""
    return {"ubx": b"0" + ubx_log(), "rtcm3": b"1" + rtcm_log()}

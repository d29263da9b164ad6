"""Seeds of the binary readers: UBX, RTCM 3 and NovAtel, encoded from the same invented elements as seeds_text.py, in round numbers."""
import struct
import zlib

from seeds_bits import CLOCK, TOW, WEEK, Bits, crc24q
from seeds_frames import beidou_d1, beidou_d2, galileo_page, glonass_string, gps_subframe


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
        log += ubx_subframe(0, 3, gps_subframe(number)) + ubx_subframe(6, 5, glonass_string(number), 0, 8)
    for number in (1, 2, 3):
        log += ubx_subframe(3, 21, beidou_d1(number))
    for page in range(1, 11):
        log += ubx_subframe(3, 3, beidou_d2(page), 1)
    for word in range(1, 6):
        log += ubx_subframe(2, 11, galileo_page(word), 1)
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


def rtcm_legacy(number, second):
    """Messages 1004 and 1012 of two carriers: 21 000 km, on the second one 6 m more; phases 3 m less and 4 m less than the first code."""
    gps = number == 1004
    b = Bits().put(number, 12).put(1, 12).put((TOW + second + (0 if gps else 3 * 3600 - 18)) * 1000, 30 if gps else 27)
    b.put(1 if gps else 0, 1).put(2 if gps else 1, 5).put(0, 4)
    modulus = 299792.458 * (1 if gps else 2)
    for satellite in (3, 12) if gps else (5,):
        b.put(satellite, 6).put(0, 1)
        if not gps:
            b.put(8, 5)
        b.put(round(21e6 % modulus / 0.02), 24 if gps else 25).put(-6000, 20).put(20, 7).put(int(21e6 // modulus), 8 if gps else 7).put(180, 8)
        b.put(3 if gps else 0, 2).put(300, 14).put(-8000, 20).put(20, 7).put(160, 8)
    return rtcm(b)


def rtcm_station():
    """The place of a base on the equator, and its antenna."""
    place = Bits().put(1006, 12).put(1, 12).put(0, 10).put(63781370000, 38).put(0, 2).put(0, 38).put(0, 2).put(0, 38).put(15000, 16)
    antenna = Bits().put(1033, 12).put(1, 12).put(20, 8)
    for letter in b"SEED            NONE":
        antenna.put(letter, 8)
    return rtcm(place) + rtcm(antenna.put(0, 8 + 4 * 8))


def rtcm_log():
    log = rtcm_gps() + rtcm_galileo() + b"text between frames\r\n" + rtcm_glonass()
    moscow = (TOW + 3 * 3600 - 18) * 1000
    for epoch in range(2):
        log += rtcm_msm(1074, (3, 12), (2, 10), (TOW + epoch) * 1000, 1) + rtcm_msm(1087, (5,), (2,), moscow + 1000 * epoch, 1)
        log += rtcm_msm(1097, (11,), (2, 23), (TOW + epoch) * 1000, 1) + rtcm_msm(1124, (21,), (2,), (TOW + epoch - 14) * 1000, 0)
    return log + rtcm_station() + rtcm_legacy(1004, 2) + rtcm_legacy(1012, 2) + rtcm(Bits().put(4090, 12).put(0, 140))


def novatel_crc(data):
    return zlib.crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


def novatel_binary(number, second, body):
    log = struct.pack("<3sBHBBHHBBHIIHH", b"\xaa\x44\x12", 28, number, 0, 32, len(body), 0, 100, 180, WEEK, 1000 * (TOW + second), 0, 0, 0) + body
    return log + struct.pack("<I", novatel_crc(log))


def novatel_ascii(name, second, text):
    log = b"%s,COM1,0,80.0,FINESTEERING,%d,%d.000,02000000,cdba,16809;%s" % (name, WEEK, TOW + second, text)
    return b"#%s*%08x\r\n" % (log, novatel_crc(log))


def novatel_log():
    """Two satellites, GPS and GLONASS, in RANGE and twice in RANGECMP."""
    log, locked = b"", 7 << 10
    satellites = [(3, 0, locked, 1575.42e6), (42, 8, locked | 1 << 16, 1602.5625e6)]
    for epoch in range(3):
        full, packed = b"", []
        for number, frequency, status, carrier in satellites:
            code = 20e6 + 1e5 * number + 100.0 * epoch
            phase = -code * carrier / 299792458.0
            full += struct.pack("<HHdfdffffI", number, frequency, code, 0.1, phase, 0.01, -500.0, 45.0, 10.0 + epoch, status)
            bits = status | (-500 * 256 & (1 << 28) - 1) << 32 | round(code * 128) << 60 | (round(phase * 256) & (1 << 32) - 1) << 96
            bits |= number << 136 | 32 * (10 + epoch) << 144 | 25 << 165 | frequency << 170
            packed.append(bits.to_bytes(24, "little"))
        if epoch == 0:
            log += novatel_binary(43, epoch, struct.pack("<I", len(satellites)) + full)
        elif epoch == 1:
            log += novatel_binary(140, epoch, struct.pack("<I", len(satellites)) + b"".join(packed))
        else:
            log += novatel_ascii(b"RANGECMPA", epoch, b"2," + b",".join(record.hex().encode() for record in packed))
    return log


def seeds():
    """Name in corpus/receiver_logs, and bytes; the first chooses the reader of fuzz_receiver_logs.cpp (modulo 3)."""
    return {"ubx": b"0" + ubx_log(), "rtcm3": b"1" + rtcm_log(), "novatel": b"2" + novatel_log()}

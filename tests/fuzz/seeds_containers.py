"""Seeds of fuzz_containers: one small log of each format; the first byte chooses the reader."""
import struct
import zlib

NAMES = ["ulog", "dataflash", "mcap", "rosbag", "novatel", "ubx", "sbet", "tum", "euroc", "gpx", "waypoint", "ulog2csv", "imr", "vectornav"]


def ulog():
    def message(kind, body):
        return struct.pack("<Hc", len(body), kind) + body

    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 1000) + message(b"B", bytes(40))
    out += message(b"F", b"sensor_combined:uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;uint8_t[4] _padding0;")
    out += message(b"F", b"vehicle_gps_position:uint64_t timestamp;int32_t lat;int32_t lon;int32_t alt;uint8_t fix_type;")
    out += message(b"A", b"\0" + struct.pack("<H", 0) + b"sensor_combined") + message(b"A", b"\0" + struct.pack("<H", 1) + b"vehicle_gps_position")
    for i in range(4):
        out += message(b"D", struct.pack("<HQ6f", 0, 1000 + 4000 * i, .1, .2, .3, .1, .2, -9.8) + bytes(4))
        out += message(b"D", struct.pack("<HQiiiB", 1, 1000 + 4000 * i, 473000000, 85000000, 500000, 3))
    return out + message(b"O", struct.pack("<H", 20))


def dataflash():
    def define(kind, name, types, columns, size):
        return b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", kind, size + 3, name, types, columns)

    out = define(1, b"IMU", b"Qffffff", b"TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", 32)
    out += define(2, b"GPS", b"QBLLe", b"TimeUS,Status,Lat,Lng,Alt", 21)
    for i in range(4):
        out += b"\xa3\x95\x01" + struct.pack("<Q6f", 20000 * i, .1, .2, .3, .1, .2, -9.8)
        out += b"\xa3\x95\x02" + struct.pack("<QBiii", 20000 * i, 3, -353632610, 1491652300, 58412)
    return out


def text(value):
    return struct.pack("<I", len(value)) + value


def imu(ros1):
    head = struct.pack("<III", 1, 1700000000, 5) if ros1 else b"\0\1\0\0" + struct.pack("<II", 1700000000, 5)
    head += text(b"imu\0" if not ros1 else b"imu")
    if not ros1:
        head += bytes(-(len(head) - 4) % 8)
    return head + struct.pack("<37d", *range(37))


def mcap():
    def record(op, body):
        return struct.pack("<BQ", op, len(body)) + body

    inner = record(3, struct.pack("<H", 1) + text(b"sensor_msgs/msg/Imu") + text(b"ros2msg") + text(b""))
    inner += record(4, struct.pack("<HH", 3, 1) + text(b"/imu") + text(b"cdr") + struct.pack("<I", 0))
    inner += record(5, struct.pack("<HIQQ", 3, 0, 1, 1) + imu(False))
    chunk = struct.pack("<QQQI", 1, 2, len(inner), 0) + text(b"") + struct.pack("<Q", len(inner)) + inner
    return b"\x89MCAP0\r\n" + record(1, text(b"ros2") + text(b"")) + record(6, chunk) + inner + record(15, bytes(4))


def rosbag():
    def record(fields, data):
        return text(b"".join(text(f) for f in fields)) + text(data)

    connection = record([b"op=\x07", b"conn=\0\0\0\0", b"topic=/imu"], text(b"topic=/imu") + text(b"type=sensor_msgs/Imu"))
    message = record([b"op=\x02", b"conn=\0\0\0\0", b"time=" + bytes(8)], imu(True))
    return b"#ROSBAG V2.0\n" + record([b"op=\x03"], b" ") + record([b"op=\x05", b"compression=none", b"size=\0\0\0\0"], connection + message)


def novatel_crc(data):
    return zlib.crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


def novatel():
    best = b"BESTPOSA,COM1,0,85.0,FINESTEERING,2200,1000.000,02040008,b1f6,32768;SOL_COMPUTED,SINGLE,51.1,-114.0,1059.7,-16.9,WGS84,1.8,1.5,2.8,\"\",0.0,0.0,20,18,18,0,00,00,00,11"
    raw = b"\xaa\x44\x13" + struct.pack("<BHHI", 40, 1462, 2200, 1000000) + struct.pack("<BBHdI6i", 0, 31, 2200, 1000.0, 0, 1, 2, 3, 4, 5, 6)
    return b"#" + best + b"*%08x\r\n" % novatel_crc(best) + raw + struct.pack("<I", novatel_crc(raw))


def ubx():
    payload = bytes(4) + b"".join(struct.pack("<II", kind << 24 | 4096, 1000 + 256 * i) for i in range(3) for kind in (14, 13, 5, 16, 17, 18))
    body = b"\x10\x03" + struct.pack("<H", len(payload)) + payload
    a = b = 0
    for c in body:
        a = a + c & 255
        b = b + a & 255
    return b"\xb5\x62" + body + bytes([a, b])


def vectornav():
    body = b"\x09" + struct.pack("<HH", 0x0203, 0x02ba) + struct.pack("<QQ6f", 1000, 1330560400000000000, 0, 0, -9.8, .1, .2, .3)
    body += struct.pack("<QBB3d3f3f", 400000000000, 12, 3, 48, 11, 500, 1, 2, 3, .1, .2, .3)
    crc = 0
    for byte in body:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return (b"\xfa" + body + struct.pack(">H", crc)) * 3


def seeds():
    rows = b"".join(b"%d.5 1 2 3 0 0 0.6 0.8\n" % i for i in range(3))
    content = {
        "ulog": ulog(), "dataflash": dataflash(), "mcap": mcap(), "rosbag": rosbag(), "novatel": novatel(), "ubx": ubx(), "vectornav": vectornav(),
        "sbet": b"".join(struct.pack("<17d", 1000 + i, .5, -2, 100, 1, 2, 3, .1, .2, 3, 0, 0, 0, 0, 0, 0, 0) for i in range(3)),
        "tum": b"# time x y z qx qy qz qw\n" + rows,
        "euroc": b"#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n1403715524907143168,1,2,3,1,0,0,0\n",
        "gpx": b"<gpx><trk><trkseg><trkpt lat=\"48.1\" lon=\"11.5\"><ele>500</ele><time>2024-05-01T12:00:00.25Z</time></trkpt></trkseg></trk></gpx>",
        "waypoint": b"GPSTime Week Latitude Longitude H-Ell Heading Pitch Roll\n100.0 2200 -48 30 36.0 11 15 0.0 512.5 90 1 2\n",
        "imr": b"$IMURAW\0\0" + struct.pack("<diidddiid", 8.8, 1, 1, 100.0, 1e-6, 1e-6, 2, 2, 0.0) + bytes(447) + struct.pack("<d6i", 1000.0, 1, 2, 3, 4, 5, 6),
        "ulog2csv": b"timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],accelerometer_m_s2[1],accelerometer_m_s2[2]\n1000,1,2,3,4,5,6\n",
    }
    return {name: bytes([NAMES.index(name)]) + data for name, data in content.items()}

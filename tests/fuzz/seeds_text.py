"""Seeds of the text readers: RINEX 2, 3 and 4, SP3, ANTEX. Every number is invented: a station in the Gulf of Guinea (0 N, 0 E) and the
same round orbit elements for every satellite."""

# The order of the broadcast message, RINEX 3.04 table A5 onwards: four values a line after the line of satellite and clock.
CLOCK = (1e-4, 1e-12, 0.0)
KEPLER = [(11, 50.0, 4.5e-9, 0.25), (1e-6, 0.01, 8e-6, 5153.5), (36000.0, 1e-7, 1.0, -1e-7), (0.96, 250.0, -0.5, -8e-9)]
# x, y, z: position km, velocity km/s, acceleration km/s^2; health, channel, age of the information behind them
STATE = [(10000.0, 1.0, 0.0), (-15000.0, 2.0, 1e-9), (18000.0, -2.0, -2e-9)]
WEEK, DAY = 2244, (2023, 1, 8)


def labelled(text, label):
    return f"{text:<60}{label:<20}\n"


def wide(values):
    return "".join(f"{value:19.12E}" for value in values)


def rows(values_by_line, margin):
    return "".join(" " * margin + wide(values) + "\n" for values in values_by_line)


def tails(letter):
    """Lines 5 to 7, where the systems differ: sources and week; accuracy, health, delays; transmission and fit interval."""
    sources = {"E": 513.0, "G": 1.0, "J": 1.0}.get(letter, 0.0)
    week = WEEK - 1356 if letter == "C" else WEEK
    delays = (5e-9, 6e-9) if letter in "EC" else (5e-9, 11.0)
    return [(1e-10, sources, week, 0.0), (2.0, 0.0, *delays), (35986.0, 4.0)]


def record(satellite, narrow=False):
    """One ephemeris; `narrow` as RINEX 2 does: two digits of the year, no letter, a column less."""
    letter = satellite[0]
    state = letter in "RS"
    clock = (CLOCK[0], 1e-12, 35100.0) if state else CLOCK
    hour, minute = (9, 45) if state else (10, 0)
    year, month, day = DAY
    if narrow:
        line = f"{int(satellite[1:]):2d} {year % 100:02d} {month:2d} {day:2d} {hour:2d} {minute:2d}{0.0:5.1f}"
    else:
        line = f"{satellite} {year:4d} {month:02d} {day:02d} {hour:02d} {minute:02d} 00"
    last = (0.0, 1.0, 0.0) if letter == "R" else (0.0, 2.0, 0.0)
    scale = 1.7 if letter == "S" else 1.0  # SBAS is geostationary
    body = [(scale * x, *rest, end) for (x, *rest), end in zip(STATE, last)] if state else KEPLER + tails(letter)
    return line + wide(clock) + "\n" + rows(body, 3 if narrow else 4)


def navigation2(letter):
    kind = {"G": "N: GPS NAV DATA", "R": "GLONASS NAV DATA"}[letter]
    head = labelled(f"     2.11           {kind}", "RINEX VERSION / TYPE") + labelled("seed", "PGM / RUN BY / DATE")
    if letter == "G":
        head += labelled("    1.0000D-08  1.0000D-08 -1.0000D-07  0.0000D+00", "ION ALPHA")
        head += labelled("    1.0000D+05  0.0000D+00 -1.0000D+05  0.0000D+00", "ION BETA")
        head += labelled("    18", "LEAP SECONDS")
    # the exponent as Fortran writes it
    return (head + labelled("", "END OF HEADER")) + (record(letter + "03", True) + record(letter + "12", True)).replace("E", "D")


def navigation3():
    head = labelled("     3.04           N: GNSS NAV DATA    M: MIXED", "RINEX VERSION / TYPE")
    for name in ("GPSA", "GPSB", "BDSA", "BDSB"):
        head += labelled(f"{name} " + "  1.0000E-08" * 4, "IONOSPHERIC CORR")
    head += labelled("GAL  " + "  5.0000E-01" * 3 + "  0.0000E+00", "IONOSPHERIC CORR")
    return head + labelled("", "END OF HEADER") + "".join(map(record, ("G03", "R05", "E11", "C21", "J02", "S20", "I04")))


def navigation4():
    head = labelled("     4.00           N: GNSS NAV DATA    M: MIXED", "RINEX VERSION / TYPE")
    text = head + labelled("", "END OF HEADER")
    for satellite, message in (("G03", "LNAV"), ("R05", "FDMA"), ("E11", "INAV"), ("E11", "FNAV"), ("C03", "D2"), ("C21", "D1"),
                               ("J02", "LNAV"), ("S20", "SBAS"), ("I04", "LNAV"), ("G03", "CNAV")):
        text += f"> EPH {satellite} {message}\n{record(satellite)}"
    date = "    2023 01 08 10 00 00"
    text += f"> ION G03 LNAV\n{date}{wide((1e-8, 1e-8, -1e-7))}\n" + rows([(0.0, 1e5, 0.0, -1e5), (0.0,)], 4)
    text += f"> ION E11 IFNV\n{date}{wide((50.0, 0.5, 0.005))}\n" + rows([(0.0,)], 4)
    return text + f"> STO G03 LNAV\n{date} GPUT\n" + rows([(35986.0, 1e-9, 0.0, 0.0)], 4)


def observation(version, satellite, epoch):
    """Code, phase (lock lost in the first epoch), Doppler and C/N0, of one satellite at one epoch."""
    code = 20e6 + 1e5 * int(satellite[1:]) + 100.0 * epoch
    lost = "1" if epoch == 0 else " "
    values = [f"{code:14.3f}  ", f"{5 * code:14.3f}{lost}7", f"{-500.0:14.3f}  ", f"{45.0:14.3f}  "]
    if version < 3:
        values.append(f"{code + 5.0:14.3f}  ")
        values.append(f"{4 * code:14.3f} 6")
        return "".join(values[:5]).rstrip() + "\n" + values[5].rstrip() + "\n"
    return satellite + "".join(values).rstrip() + "\n"


def observations2():
    head = labelled("     2.11           OBSERVATION DATA    M (MIXED)", "RINEX VERSION / TYPE") + station()
    head += labelled("     6" + "".join(f"{code:>6}" for code in ("C1", "L1", "D1", "S1", "P2", "L2")), "# / TYPES OF OBSERV")
    text = head + labelled("", "END OF HEADER")
    names = [f"G{n:02d}" for n in range(1, 10)] + [f"R{n:02d}" for n in range(1, 6)]  # two lines of names
    for epoch in range(2):
        for i in range(0, len(names), 12):
            start = f" 23  1  8 10  0{epoch:11.7f}  0{len(names):3d}" if i == 0 else " " * 32
            text += start + "".join(names[i:i + 12]) + "\n"
        text += "".join(observation(2, name, epoch) for name in names)
        if epoch == 0:
            text += " " * 28 + "4  1\n" + labelled("an event between the epochs", "COMMENT")
    return text


def station():
    return (labelled("SEED", "MARKER NAME") + labelled("  6378137.0000        0.0000        0.0000", "APPROX POSITION XYZ")
            + labelled("        1.5000        0.0000        0.0000", "ANTENNA: DELTA H/E/N"))


def observations(version):
    head = labelled(f"     {version:4.2f}           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE") + station()
    for letter, signal in zip("GRECJSI", ("1C", "1C", "1X", "2I", "1C", "1C", "5A")):
        head += labelled(f"{letter}    4 C{signal} L{signal} D{signal} S{signal}", "SYS / # / OBS TYPES")
    head += labelled("  2023     1     8    10     0    0.0000000     GPS", "TIME OF FIRST OBS")
    text = head + labelled("  1 R05  1", "GLONASS SLOT / FRQ #") + labelled("", "END OF HEADER")
    names = ("G03", "G12", "R05", "E11", "C21", "J02", "S20", "I04")
    for epoch in range(3):
        flag = 1 if epoch == 2 else 0  # power failed before the last one
        text += f"> 2023 01 08 10 00{epoch:11.7f}  {flag}{len(names):3d}\n" + "".join(observation(3, n, epoch) for n in names)
    return text


def sp3():
    text = "#dP2023  1  8 10  0  0.00000000       3 ORBIT SEED  FIT SEED\n"
    text += "## 2244  36000.00000000   900.00000000 59952 0.4166666666667\n"
    text += "+    3   G03R05E11" + "  0" * 14 + "\n" + "%c M  cc GPS ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc\n"
    for epoch in range(3):
        text += f"*  2023  1  8 10 {15 * epoch:2d}  0.00000000\n"
        for name, x in (("G03", 15000.0), ("R05", 14000.0), ("E11", 17000.0)):
            clock = 999999.999999 if name == "R05" else 100.0 + epoch
            text += f"P{name}{x + 100.0 * epoch:14.6f}{15000.0:14.6f}{-15000.0:14.6f}{clock:14.6f}\n"
    return text + "EOF\n"


def antex():
    def line(text, label):
        return f"{text:60}{label}\n"

    def carrier(code, rows):
        return line(f"   {code}", "START OF FREQUENCY") + line("      1.00     -2.00     66.80", "NORTH / EAST / UP") + "".join(
            f"{name:>8}" + "".join(f"{value:8.2f}" for value in (0.0, -1.5, 3.0)) + "\n" for name in rows) + line(f"   {code}", "END OF FREQUENCY")

    text = line("     1.4            M", "ANTEX VERSION / SYST") + line("", "END OF HEADER")
    for kind, step in (("SEED            NONE", 0.0), ("BLOCK IIF           G03", 180.0)):
        text += line("", "START OF ANTENNA") + line(kind, "TYPE / SERIAL NO") + line(f"  {step:6.1f}", "DAZI")
        text += line("     0.0  90.0  45.0", "ZEN1 / ZEN2 / DZEN") + line("  2011     7    16     0     0    0.0000000", "VALID FROM")
        text += carrier("G01", ["NOAZI"] + (["0.0", "180.0", "360.0"] if step else [])) + line("", "END OF ANTENNA")
    return text


def seeds():
    """Name in corpus/rinex, and text; the first letter chooses the reader of fuzz_rinex.cpp (its code modulo 4)."""
    return {"navigation2_gps": "1" + navigation2("G"), "navigation2_glonass": "1" + navigation2("R"),
            "navigation3": "1" + navigation3(), "navigation4": "1" + navigation4(), "observation2": "0" + observations2(),
            "observation3": "0" + observations(3.04), "observation4": "0" + observations(4.0), "sp3": "2" + sp3(),
            "antex": "3" + antex()}

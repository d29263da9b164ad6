"""What satellites send piece by piece, as receivers log it: words of GPS, BeiDou, Galileo, GLONASS with the invented elements."""
from seeds_bits import CLOCK, ORBIT, TOW, WEEK, Bits, crc24q

# GPS: which data bits each parity bit sums, and which of the last two bits of the word before (IS-GPS-200, table 20-XIV)
PARITY = [(0, (1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23)), (1, (2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24)),
          (0, (1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22)), (1, (2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23)),
          (1, (1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24)), (0, (3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24))]
KLOBUCHAR = list(zip((1e-8, 1e-8, -1e-7, 0.0, 1e5, 0.0, -1e5, 0.0), (-30, -27, -24, -24, 11, 14, 16, 16)))


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
        for value, exponent in KLOBUCHAR:
            b.scaled(value, 8, exponent)
        b.put(0, 72).put(18, 8).put(0, 40)
    return gps_words(b)


def galileo_page(word):
    """Words 1 to 5 of I/NAV: an even and an odd half of 120 bits, each in four words of 32."""
    b = Bits().put(word, 6)
    if word < 5:
        b.put(11, 10)
    if word == 1:
        b.put(TOW // 60, 14).orbit("m0", "e", "sqrt_a").put(0, 2)
    elif word == 2:
        b.orbit("omega0", "i0", "omega", "idot").put(0, 2)
    elif word == 3:
        b.orbit("omega_dot", "delta_n", "cuc", "cus", "crc", "crs").put(107, 8)
    elif word == 4:
        b.put(11, 6).orbit("cic", "cis").put(TOW // 60, 14)
        b.scaled(CLOCK[0], 31, -34).scaled(CLOCK[1], 21, -46).scaled(CLOCK[2], 6, -59).put(0, 2)
    else:
        b.scaled(50.0, 11, -2).scaled(0.5, 11, -8).scaled(0.005, 14, -15).put(0, 5).scaled(5e-9, 10, -32).scaled(6e-9, 10, -32)
        b.put(0, 6).put(WEEK - 1024, 12).put(TOW, 20).put(0, 23)
    even = "00" + b.text[:112]
    odd = "10" + b.text[112:] + "0" * 64
    check = format(crc24q(int("0000" + even + odd, 2).to_bytes(25, "big")), "024b")
    halves = (even + "0" * 14, odd + check + "0" * 22)
    return [int(half[i:i + 32], 2) for half in halves for i in range(0, 128, 32)]


def beidou_words(bits):
    """Ten words: 26 bits of information in the first, 22 in the others; the parity, which receivers check, is left zero."""
    text = bits.text.ljust(224, "0")
    pieces = [text[:26]] + [text[26 + 22 * i:48 + 22 * i] for i in range(9)]
    return [int(piece.ljust(30, "0"), 2) for piece in pieces]


def beidou_head(number, second):
    return Bits().put(0x712, 11).put(0, 4).put(number, 3).put(second, 20)


def beidou_clock(b):
    return b.put(0, 1).put(11, 5).put(0, 4).put(WEEK - 1356, 13).put(TOW // 8, 17).put(50, 10).put(60, 10)


def beidou_d1(number):
    b = beidou_head(number, TOW + 6 * (number - 1))
    if number == 1:
        beidou_clock(b)
        for value, exponent in KLOBUCHAR:
            b.scaled(value, 8, exponent)
        b.scaled(CLOCK[2], 11, -66).scaled(CLOCK[0], 24, -33).scaled(CLOCK[1], 22, -50).put(11, 5)
    elif number == 2:
        b.beidou("delta_n", "cuc", "m0", "e", "cus", "crc", "crs", "sqrt_a").put(TOW // 8 >> 15, 2)
    else:
        b.put(TOW // 8, 15).beidou("i0", "cic", "omega_dot", "cis", "idot", "omega0", "omega").put(0, 1)
    return beidou_words(b)


def beidou_d2(page):
    """Ten pages; from the third on one row of numbers, cut to so many bits a page, after as many bits of other things."""
    b = beidou_head(1, TOW + 3 * (page - 1)).put(page, 4)
    row = Bits().scaled(CLOCK[0], 24, -33).scaled(CLOCK[1], 22, -50).scaled(CLOCK[2], 11, -66).put(11, 5)
    row.beidou("delta_n", "cuc", "m0", "cus", "e", "sqrt_a", "cic", "cis").put(TOW // 8, 17)
    row.beidou("i0", "crc", "crs", "omega_dot", "omega0", "omega", "idot")
    sizes = (28, 64, 64, 64, 64, 66, 64, 19)
    if page == 1:
        beidou_clock(b)
    elif page > 2:
        if page == 3:
            b.put(0, 38)
        first = sum(sizes[:page - 3])
        b.text += row.text[first:first + sizes[page - 3]]
    return beidou_words(b)


def glonass_string(number):
    """A string with bit 85 first, its check bits last, and the numbers of superframe and frame."""
    b = Bits().put(0, 1).put(number, 4)
    state = ((10000.0, 1.0, 0.0), (-15000.0, 2.0, 1e-9), (18000.0, -2.0, -2e-9))
    if number < 4:
        if number == 1:
            b.put(0, 16)
        elif number == 2:
            b.put(0, 4).put(51, 7).put(0, 5)  # reference 12:45 in Moscow, the 51st quarter of an hour
        else:
            b.put(0, 1).magnitude(1e-12, 11, -40).put(0, 4)
        x, v, a = state[number - 1]
        b.magnitude(v, 24, -20).magnitude(a, 5, -30).magnitude(x, 27, -11)
    else:
        b.magnitude(-1e-4, 22, -30).magnitude(2e-9, 5, -30).put(0, 5 + 14 + 1 + 4 + 3).put(739, 11).put(5, 5).put(1, 2)
    # bits 9 to 85 of the string take the places of Hamming's code that are no powers of two
    places = [place for place in range(3, 90) if place & (place - 1)]
    check = 0
    for place, bit in zip(places, reversed(b.text)):
        check ^= place * int(bit)
    low = format(check, "07b")
    b.text += str((b.text + low).count("1") % 2) + low
    return [int(b.text.ljust(96, "0")[i:i + 32], 2) for i in (0, 32, 64)] + [1 << 16 | 1]

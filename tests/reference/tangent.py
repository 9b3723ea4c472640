"""The tangent of the Rust crate libm 0.2.16, bit for bit, for 0 <= x <= 3*pi/4.

Python's math.tan is the platform's, which may differ in the last bit. The coefficients, the
splitting of pi/2 and the order of the operations are those of FreeBSD's msun (s_tan.c, k_tan.c,
e_rem_pio2.c), whose notice is:

    Copyright (C) 1993, 2004 by Sun Microsystems, Inc. All rights reserved.

    Developed at SunPro, a Sun Microsystems, Inc. business.
    Permission to use, copy, modify, and distribute this
    software is freely granted, provided that this notice
    is preserved.
"""

import struct

# tan(x) ~ x + T[0]*x**3 + ... + T[12]*x**27 on [0, 0.67434]
T = (
    3.33333333333334091986e-01,
    1.33333333333201242699e-01,
    5.39682539762260521377e-02,
    2.18694882948595424599e-02,
    8.86323982359930005737e-03,
    3.59207910759131235356e-03,
    1.45620945432529025516e-03,
    5.88041240820264096874e-04,
    2.46463134818469906812e-04,
    7.81794442939557092300e-05,
    7.14072491382608190305e-05,
    -1.85586374855275456654e-05,
    2.59073051863633712884e-05,
)
PI_4 = 7.85398163397448278999e-01
PI_4_LOW = 3.06161699786838301793e-17

# pi/2 in pieces of 33 bits, each with the remainder
PI_2_1 = 1.57079632673412561417e00
PI_2_1_REST = 6.07710050650619224932e-11
PI_2_2 = 6.07710050630396597660e-11
PI_2_2_REST = 2.02226624879595063154e-21
PI_2_3 = 2.02226624871116645580e-21
PI_2_3_REST = 8.47842766036889956997e-32


def bits(x):
    """The 64 bits of a double, as an integer."""
    return struct.unpack("<Q", struct.pack("<d", x))[0]


def high_word(x):
    """The upper 32 bits: sign, exponent, and 20 bits of the fraction."""
    return bits(x) >> 32


def without_low_word(x):
    """x with the lower 32 bits of the fraction cleared."""
    return struct.unpack("<d", struct.pack("<Q", bits(x) & 0xFFFFFFFF00000000))[0]


def exponent(x):
    """The biased exponent."""
    return (bits(x) >> 52) & 0x7FF


def reduced(x):
    """x - pi/2 as a double and its tail."""
    if high_word(x) != 0x3FF921FB:
        z = x - PI_2_1
        y0 = z - PI_2_1_REST
        return y0, (z - y0) - PI_2_1_REST
    # So close to pi/2 that 33 + 53 bits may not be enough.
    r = x - PI_2_1
    w = PI_2_1_REST
    y0 = r - w
    if exponent(x) - exponent(y0) > 16:
        t = r
        w = PI_2_2
        r = t - w
        w = PI_2_2_REST - ((t - r) - w)
        y0 = r - w
        if exponent(x) - exponent(y0) > 49:
            t = r
            w = PI_2_3
            r = t - w
            w = PI_2_3_REST - ((t - r) - w)
            y0 = r - w
    return y0, (r - y0) - w


def kernel(x, y, odd):
    """tan(x + y), or -1/tan(x + y) where odd, for |x| <= pi/4 and its tail y."""
    word = high_word(x)
    negative = word >> 31 == 1
    big = word & 0x7FFFFFFF >= 0x3FE59428
    if big:
        if negative:
            x, y = -x, -y
        x = (PI_4 - x) + (PI_4_LOW - y)
        y = 0.0
    z = x * x
    w = z * z
    r = T[1] + w * (T[3] + w * (T[5] + w * (T[7] + w * (T[9] + w * T[11]))))
    v = z * (T[2] + w * (T[4] + w * (T[6] + w * (T[8] + w * (T[10] + w * T[12])))))
    s = z * x
    r = y + z * (s * (r + v) + y) + s * T[0]
    w = x + r
    if big:
        s = -1.0 if odd else 1.0
        v = s - 2.0 * (x + (r - w * w / (w + s)))
        return -v if negative else v
    if not odd:
        return w
    w0 = without_low_word(w)
    v = r - (w0 - x)
    a = -1.0 / w
    a0 = without_low_word(a)
    return a0 + a * (1.0 + a0 * w0 + a0 * v)


def tan(x):
    """The tangent of x, 0 <= x <= 3*pi/4."""
    word = high_word(x)
    if word <= 0x3FE921FB:
        return x if word < 0x3E400000 else kernel(x, 0.0, False)
    if word > 0x4002D97C:
        raise ValueError(f"tan({x!r}) is outside of 0 to 3*pi/4")
    return kernel(*reduced(x), True)

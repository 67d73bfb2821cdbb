"""Prints the golden values of noise_test.cpp, from the definition of white_noise alone."""
import math

MASK = 0xFFFFFFFF


def philox(c, k):
    for _ in range(10):
        a, b = 0xD2511F53 * c[0], 0xCD9E8D57 * c[2]
        c = [(b >> 32) ^ c[1] ^ k[0], b & MASK, (a >> 32) ^ c[3] ^ k[1], a & MASK]
        k = [(k[0] + 0x9E3779B9) & MASK, (k[1] + 0xBB67AE85) & MASK]
    return c


def white_noise(seed, stream, channel, tick):
    w = philox([tick & MASK, tick >> 32 & MASK, stream, channel], [seed & MASK, seed >> 32])
    u = [(((w[i] << 32 | w[i + 1]) >> 11) + 1) * 2.0**-53 for i in (0, 2)]
    radius = math.sqrt(-2 * math.log(u[0]))
    return radius * math.cos(2 * math.pi * u[1]), radius * math.sin(2 * math.pi * u[1])


for key in ((0, 0, 0, 0), (2024, 3, 0, 1), (2024, 3, 1, 1), (1 << 40, 9, 0, (1 << 33) + 7), (1, 0, 0, -1)):
    print(key, *(f"{value:.17g}" for value in white_noise(*key)))

"""Small changes to a file's bytes, of the kinds that break readers."""

import random

TOKENS = [
    b"\0", b"\xff", b"\xef\xbb\xbf", b"\r\n", b"\n\n", b'"', b"'", b",", b",,,", b":", b"\t", b"[", b"]", b"{", b"}",
    b"-",
    b"null", b"true", b"NaN", b"-Infinity", b"1e999", b"-1", b"0", b"1e-320", b"9" * 30, b"9" * 5000,
    b"\\ud800", b"\\u0000",
    b"[" * 60, b"{\"a\":" * 60, b"[" * 3000, b"- " * 60, b"&a *a", b"!!python/object:os.system", b"2024-13-45",
    b"<<: *a",
    b"\x1b[2J", "\u202e".encode(), "\u2028".encode(), b"x" * 20_000, b"=cmd()", b"../../etc/passwd", b"/dev/zero",
    b"%s%n",
]  # fmt: skip


def mutated(seeds: list[bytes], rng: random.Random) -> bytes:
    """One of the seeds with one to four changes."""
    data = bytearray(rng.choice(seeds))
    for _ in range(rng.randint(1, 4)):
        place = rng.randint(0, len(data))
        end = min(len(data), place + int(rng.expovariate(1 / 20)))
        match rng.randrange(7):
            case 0:
                data[place:end] = rng.randbytes(end - place)
            case 1:
                del data[place:end]
            case 2:
                data[place:place] = rng.choice(TOKENS)
            case 3:
                data[place:end] = rng.choice(TOKENS)
            case 4:
                del data[place:]
            case 5:
                data[place:place] = data[place:end] * rng.randint(1, 5)
            case 6:
                other = rng.choice(seeds)
                start = rng.randint(0, len(other))
                data[place:end] = other[start : start + 100]
    return bytes(data)

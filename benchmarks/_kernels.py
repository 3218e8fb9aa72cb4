"""What this machine can do at best: memory streamed and arithmetic done by compiled loops without ``fastmath``."""

from scenarios.kernels.jit import kernel

OPERATIONS = 12


@kernel
def triad(a, b, c):
    """STREAM's triad: a = b + 3 c, three arrays (N,) far larger than any cache."""
    for i in range(a.shape[0]):
        a[i] = b[i] + 3.0 * c[i]


@kernel
def multiply_add(x, rounds):
    """``rounds`` times ``OPERATIONS`` multiplications and additions on each of ``x`` (N,), which stays in first cache.

    A longer chain would wait for its own results, a shorter one for the cache.
    """
    for _ in range(rounds):
        for i in range(x.shape[0]):
            y = x[i]
            y = y * 0.5 + 0.25
            y = y * 0.5 + 0.25
            y = y * 0.5 + 0.25
            y = y * 0.5 + 0.25
            y = y * 0.5 + 0.25
            y = y * 0.5 + 0.25
            x[i] = y

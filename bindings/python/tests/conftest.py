# SPDX-License-Identifier: MIT
import signal

import numpy as np
import pytest


@pytest.fixture
def random():
    return np.random.default_rng(20)


@pytest.fixture
def cube():
    """Eight corners and twelve triangles of the cube [-1, 1]³, counter-clockwise from outside."""
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype="f4")
    indices = np.array(
        [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5],
        dtype="u4",
    )
    return corners, indices


def pytest_configure():
    # A shell starts what runs in the background with Ctrl-C ignored: tests that press it would never end.
    signal.signal(signal.SIGINT, signal.default_int_handler)

# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Signals, progress, threads and memory of long calls."""

import os
import random
import signal
import threading
import time

import numpy as np
import pytest

import vdb_madf as madf


@pytest.fixture(scope="module")
def long_work():
    """A mask whose segmentation takes half a second or so."""
    return madf.generate("pack", size=300, fraction=0.4)[0]


@pytest.fixture(autouse=True)
def hear_signals():
    """Also where SIGINT was turned off, as for what a shell runs in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupted_after(seconds, work):
    """Runs the work, sends SIGINT meanwhile. Seconds that all threads work from the signal to the
    KeyboardInterrupt, or None if the work was done before."""
    sent = []

    def send():
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)
    timer = threading.Timer(seconds, send)
    timer.start()
    try:
        work()
        timer.cancel()
        timer.join()
        time.sleep(0)  # a signal that came at the end
        return None
    except KeyboardInterrupt:
        return time.process_time() - sent[0]
    finally:
        timer.cancel()
        timer.join()


def test_ctrl_c_at_random_times(long_work):
    start = time.monotonic()
    want = madf.segment(long_work, keep=()).counts
    whole = time.monotonic() - start
    draw, heard = random.Random(11), []
    for _ in range(12):
        try:
            took = interrupted_after(draw.uniform(0, 0.9) * whole,
                                     lambda: madf.segment(long_work, keep=()))
        except KeyboardInterrupt:  # between the end of the work and that of the timer
            continue
        if took is not None:
            heard.append(took)
    assert len(heard) >= 4
    assert sorted(heard)[-1] < 1
    assert madf.segment(long_work, keep=()).counts == want


def test_ctrl_c_while_an_array_is_read():
    class Slow:
        shape, dtype = (4000, 8, 8), np.dtype(np.uint8)

        def __getitem__(self, key):
            time.sleep(0.01)
            return np.zeros((key.stop - key.start, 8, 8), np.uint8)

    assert interrupted_after(0.2, lambda: madf.Mask(Slow())) < 1


def test_progress_is_heard(long_work):
    heard, caller = [], threading.get_ident()

    def progress(percent, stage):
        assert threading.get_ident() == caller
        heard.append((time.monotonic(), percent, stage))
    madf.segment(long_work, keep=(), progress=progress)
    times, percents, stages = zip(*heard)
    assert all(0 <= p <= 100 for p in percents) and "power_map" in stages
    assert all(b - a > 0.04 for a, b in zip(times, times[1:]))


def test_progress_that_raises_stops_the_work(long_work):
    def progress(percent, stage):
        raise ZeroDivisionError("enough")
    with pytest.raises(ZeroDivisionError, match="enough"):
        madf.segment(long_work, progress=progress)
    with pytest.raises(SystemExit):
        madf.segment(long_work, progress=lambda percent, stage: exit(3))
    assert madf.segment(long_work, keep=()).counts["grains"] > 0


def test_a_bar(long_work, capsys):
    pytest.importorskip("tqdm", reason="progress bars: tqdm is not installed")
    madf.segment(long_work, progress=True)
    assert "%" in capsys.readouterr().err
    madf.segment(long_work)
    assert capsys.readouterr() == ("", "")


def test_other_threads_run_meanwhile(long_work):
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)
    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    madf.segment(long_work, keep=())
    stop = time.monotonic()
    done.set()
    thread.join()
    inside = [t for t in ticks if start < t < stop]
    assert len(inside) > 5


def test_calls_in_several_threads(sample):
    want = np.asarray(madf.segment(sample[0]).labels)
    results = {}

    def work(i):
        results[i] = np.asarray(madf.segment(np.asarray(sample[0]), threads=1 + i % 2).labels)
    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 4 and all((labels == want).all() for labels in results.values())


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_is_given_back():
    array = np.asarray(madf.generate("sintered", size=40, count=5, radius=(7, 10))[0])

    def work():
        seg = madf.segment(array)
        madf.measure(seg.remerge(strictness=9).labels)
        seg.labels.mesh()
        return seg.labels[20].sum()
    for _ in range(20):
        work()
    before = resident()
    for _ in range(80):
        work()
    assert resident() - before < 8 * 2**20

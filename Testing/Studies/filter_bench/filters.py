# SPDX-License-Identifier: BSD-3-Clause
"""What the baselines of the bench share: scans as range images, features of points, and predictions that are tuned and written."""
import pathlib
import sys

import numpy as np

from running import argument, study

FIRST = 8        # scans of a sequence that are history: not scored
HISTORY = 8      # scans that filters with a memory look back
LEARNED, TUNED = "hongqiao-train", "honolulu"  # sets to train on and to tune at, and their twins in rain
TESTED = ("hongqiao", "honolulu", "neubrandenburg")
RAIN = "-rain"
BIRD, MOVING = 99, (252, 258, 259)  # labels
FAR = 50.0       # m: a neighbour that far is none
NEAR = 1.5       # m: two range units, that close an echo is the same in another scan or beam
MANY = 200_000   # points that show the channels and columns of a sensor
WIDTH = 10_000.0  # m, more than a range gate


class Frame:
    """A scan as an image of channels and columns with all returns of each beam, nearest first."""

    def __init__(self, points, step=None):
        """@param points n x 4: x forward, y left, z up (m), intensity @param step between columns, deg; default: the smallest"""
        x, y, z, self.amplitude = np.asarray(points, float).T
        self.range = np.sqrt(x * x + y * y + z * z)
        self.elevation, azimuth = np.degrees(np.arctan2(z, np.hypot(x, y))), np.degrees(np.arctan2(-y, x)) % 360.0
        levels = np.unique(np.round(self.elevation, 2))
        self.levels = levels[np.append(True, np.diff(levels) > 0.05)] if len(levels) else levels
        if step is None:
            gaps = np.diff(np.unique(np.round(azimuth, 3)))
            step = gaps[gaps > 0.05].min(initial=360.0)
        self.columns = max(1, round(360.0 / step))
        self.column = np.rint(azimuth * (self.columns / 360.0)).astype(int) % self.columns
        self._lay()

    def _lay(self):
        """Sort the points by beam and range."""
        self.row = np.searchsorted((self.levels[1:] + self.levels[:-1]) / 2.0, self.elevation)
        self.beam = self.column * len(self.levels) + self.row
        key = self.beam * WIDTH + self.range
        self.order = np.argsort(key, kind="stable")
        self.key = key[self.order]

    def with_levels(self, levels):
        """The same with the channels of a sensor, also those without a point here."""
        self.levels = levels
        self._lay()
        return self

    def nearest(self, of, rows=0, columns=0):
        """(distance in range, m, to the nearest point of the beam so many channels and columns beside; its amplitude) for each point of a
        frame, in the order of its beams; `FAR` and 0 without one."""
        row, column = of.row[of.order] + rows, (of.column[of.order] + columns) % self.columns
        wanted = (column * len(self.levels) + row) * WIDTH + of.range[of.order]
        wanted[(row < 0) | (row >= len(self.levels))] = -WIDTH
        place = np.searchsorted(self.key, wanted)
        keys = np.concatenate([[-np.inf], self.key, [np.inf]])
        before, behind = wanted - keys[place], keys[place + 1] - wanted
        distance = np.minimum(before, behind)
        amplitude = np.concatenate([[0.0], self.amplitude[self.order], [0.0]])[np.where(before < behind, place, place + 1)]
        near = (distance < FAR) & (wanted >= 0.0)
        return np.where(near, distance, FAR), np.where(near, amplitude, 0.0)


def log_amplitude(amplitude):
    return np.log10(amplitude + 1e-6)


BESIDE = [(rows, columns) for rows in (-1, 0, 1) for columns in (-1, 0, 1) if rows or columns] + [(0, -2), (0, 2)]


def of_one_scan(frame):
    """Features of each point (n x k), in the order of the frame's points: amplitudes of a wall and of a small target there, other returns of
    its beam, and its neighbours. Range, elevation and height themselves are left out: at another airport clutter stands elsewhere, and trees
    that know them are worse there (seen at Honolulu)."""
    distance, beam = frame.range[frame.order], frame.beam[frame.order]
    amplitude = log_amplitude(frame.amplitude[frame.order])
    gaps = np.where(np.diff(beam) == 0, np.minimum(np.diff(distance), 2 * FAR), 2 * FAR)
    first = np.searchsorted(beam, beam)
    count = np.searchsorted(beam, beam, "right") - first
    sides = [frame.nearest(frame, *beside) for beside in BESIDE]
    away = np.array([side for side, _ in sides])
    other = np.array([np.where(side < 2 * NEAR, log_amplitude(theirs), -7.0) for side, theirs in sides])
    columns = [amplitude + 2.0 * np.log10(distance + 1.0), amplitude + 4.0 * np.log10(distance + 1.0),
               np.append(2 * FAR, gaps), np.append(gaps, 2 * FAR), count, first + count - np.arange(len(beam)),
               *((away < limit).sum(axis=0) for limit in (NEAR, 2 * NEAR, 10.0)), away.min(axis=0, initial=FAR), np.minimum(away[3], away[4]), np.minimum(away[1], away[6]),
               other.max(axis=0), amplitude - other.max(axis=0)]
    return unsorted(frame, np.column_stack(columns).astype(np.float32))


def of_history(frame, before):
    """Features of each point by the scans before, the latest last: the share of them with an echo there in the beam, in a beam beside it,
    and how many scans ago the last was."""
    shares, ago = np.zeros((2, len(frame.range))), np.full(len(frame.range), float(HISTORY + 1))
    for back, earlier in enumerate(reversed(before), 1):
        here = earlier.nearest(frame)[0] < NEAR
        beside = here | (earlier.nearest(frame, 0, -1)[0] < NEAR) | (earlier.nearest(frame, 0, 1)[0] < NEAR)
        shares += np.array([here, beside]) / len(before)
        ago = np.where(beside, np.minimum(ago, back), ago)
    return unsorted(frame, np.column_stack([*shares, ago]).astype(np.float32))


def unsorted(frame, values):
    """Values in the order of the frame's points."""
    result = np.empty_like(values)
    result[frame.order] = values
    return result


def names(home, number):
    """The names of a sequence's scans."""
    return [file.stem for file in sorted((home / "sequences" / number / "velodyne").glob("*.bin"))]


def frames(home, number):
    """(name, frame, frames before) of a sequence's scans."""
    files = [home / "sequences" / number / "velodyne" / f"{name}.bin" for name in names(home, number)]
    scans = [np.fromfile(file, "<f4").reshape(-1, 4) for file in files]
    some = np.concatenate(scans)
    every = Frame(some[::max(1, len(some) // MANY)])  # the channels and columns of the sensor
    before = []
    for file, points in zip(files, scans):
        frame = Frame(points, 360.0 / every.columns).with_levels(every.levels)
        yield file.stem, frame, tuple(before)
        before = [*before, frame][-HISTORY:]


def labels(home, number, name):
    return np.fromfile(home / "sequences" / number / "labels" / f"{name}.label", "<u4") & 0xffff


def sequences(home):
    return sorted(folder.name for folder in (home / "sequences").iterdir() if folder.name.isdigit())


def learned(sets, training):
    """{(set, number): what `training` gives of a sequence} of all that is there to learn, in fair weather and in rain."""
    homes = [sets / f"{LEARNED}{rain}" for rain in ("", RAIN)]
    if not homes[0].is_dir():
        sys.exit(f"{homes[0]}: is not there, expected what sets.py makes")
    return {(home.name, number): training(home, number) for home in homes if home.is_dir() for number in sequences(home)}


def without_one(parts):
    """(number, the parts of all other sequences) for each sequence: what the model for sequence `number` of a set learns."""
    for number in sorted({number for _, number in parts}):
        yield number, [part for (_, of), part in parts.items() if of != number]


def tuned(found):
    """The least score of a bird by which intersection over union is largest. @param found (scores, labels) of scans"""
    score, label = (np.concatenate(part) for part in zip(*found))
    score, bird = score[~np.isin(label, MOVING)], label[~np.isin(label, MOVING)] == BIRD
    order = np.argsort(-score, kind="stable")
    hit = np.cumsum(bird[order])
    union = bird.sum() + np.arange(1, len(hit) + 1) - hit
    last = np.append(np.diff(score[order]) != 0.0, True)  # points of the same score come together
    return score[order][np.argmax(np.where(last, hit / np.maximum(union, 1), -1.0))]


def predict(sets, out, kinds, scores_of):
    """Write what filters predict for all sets; their thresholds are tuned at Honolulu, for each weather.

    kinds      names of the filters
    scores_of  called with (folder of the set, number of the sequence): (name of the scan, for each kind a score of each point), for each scan
    """
    for rain in ("", RAIN):
        limits = {}
        for place in sorted(TESTED, key=lambda place: place != TUNED):
            home = sets / f"{place}{rain}"
            for number in sequences(home) if home.is_dir() else ():
                found = [(scan, np.asarray(scores, "<f4")) for scan, scores in scores_of(home, number)]
                for which, kind in enumerate(kinds):
                    if place == TUNED:
                        limits[kind, number] = tuned([(scores[which], labels(home, number, scan)) for scan, scores in found[FIRST:]])
                    folder = out / kind / home.name / "sequences" / number / "predictions"
                    folder.mkdir(parents=True, exist_ok=True)
                    for scan, scores in found:
                        scores[which].tofile(folder / f"{scan}.score")
                        np.where(scores[which] >= limits.get((kind, number), 0.5), BIRD, 0).astype("<u4").tofile(folder / f"{scan}.label")
            if home.is_dir():
                print(f"{', '.join(kinds)}: {home.name}", flush=True)


SETS = argument("--sets", type=pathlib.Path, default=pathlib.Path("build/bench/sets"),
                help="what sets.py has made, default build/bench/sets")


def baseline(*arguments):
    """What `study` makes of a baseline."""
    return study(SETS, *arguments, out="bench/predictions")

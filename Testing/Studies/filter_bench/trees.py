# SPDX-License-Identifier: BSD-3-Clause
"""Boosted trees that tell birds by features of a point and of its neighbours in the range image.

    Testing/Studies/run.py trees --sets build/bench/sets --out build/bench/predictions

makes two filters: trees-one-scan knows nothing of other scans, trees also where echoes were in the eight scans before. The model for
sequence N of a set has learned all sequences of hongqiao-train but the N-th, fair and rain. No feature says where a point is.
"""
import os

import numpy as np

os.environ.setdefault("OMP_NUM_THREADS", "1")  # on one thread, as the network
from sklearn.ensemble import HistGradientBoostingClassifier

import filters

KINDS = ("trees-one-scan", "trees")
ROUNDS = 150
MOST = 1000  # points of a scan that are learned beside those of birds


def features(frame, before):
    return np.column_stack([filters.of_one_scan(frame), filters.of_history(frame, before)])


def training(home, number):
    """(features, whether it is a bird) of a sequence: all birds, some of the rest."""
    draw, parts = np.random.default_rng(int(number)), []
    for place, (name, frame, before) in enumerate(filters.frames(home, number)):
        if place < 1:
            continue
        label = filters.labels(home, number, name)
        bird, rest = np.flatnonzero(label == filters.BIRD), np.flatnonzero((label != filters.BIRD) & ~np.isin(label, filters.MOVING))
        chosen = np.concatenate([bird, draw.permutation(rest)[:MOST]])
        parts.append((features(frame, before)[chosen], label[chosen] == filters.BIRD))
    return [np.concatenate(part) for part in zip(*parts)]


def columns_of(kind):
    """The features that a kind of trees knows; the last three are those of time."""
    return slice(0, -3 if kind.endswith("one-scan") else None)


def learn(parts, kind, seed):
    """Trees that have learned what `training` gives of some sequences."""
    values, birds = (np.concatenate(part) for part in zip(*parts))
    trees = HistGradientBoostingClassifier(max_iter=ROUNDS, max_leaf_nodes=24, min_samples_leaf=30, l2_regularization=1.0, random_state=seed)
    return trees.fit(values[:, columns_of(kind)], birds)


@filters.baseline()
def main(options):
    learned = filters.learned(options.sets, training)
    models = {(kind, number): learn(parts, kind, int(number)) for number, parts in filters.without_one(learned) for kind in KINDS}

    def scores_of(home, number):
        for name, frame, before in filters.frames(home, number):
            values = features(frame, before)
            yield name, [models[kind, number].decision_function(values[:, columns_of(kind)]) if len(values) else [] for kind in KINDS]
    filters.predict(options.sets, options.out, KINDS, scores_of)

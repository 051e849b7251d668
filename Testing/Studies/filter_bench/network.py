# SPDX-License-Identifier: BSD-3-Clause
"""A small convolutional network on the range image that tells birds.

    Testing/Studies/run.py network --sets build/bench/sets --out build/bench/predictions

makes two filters: network-one-scan knows nothing of other scans, network also where echoes were in the eight scans before. Its image has
the channels and columns of the sensor, and for each of the last four returns of a beam range and amplitude; returns before them are called
clutter. Ranges and amplitudes of each image that is learned are scaled by chance, as at another airport clutter stands elsewhere. The model for sequence N of a set has learned all sequences of hongqiao-train but the N-th, fair and rain, for --seconds
on one thread of the processor.
"""
import time

import numpy as np
import torch

import filters
from running import argument

KINDS = ("network-one-scan", "network")
SECONDS = 30.0
RETURNS = 4    # of a beam, the last ones
WIDTH = 32     # channels between the layers
CROP = 128     # columns of a training image
BATCH = 8
SCALES = 0.4, 0.5  # by which ranges and amplitudes of a crop are scaled by chance: decimal logarithm, half of it
NEVER = -30.0  # score of what is not in the image


class Network(torch.nn.Module):
    """Four convolutions; columns go around."""

    def __init__(self, inputs):
        super().__init__()
        sizes = [(inputs, WIDTH, (3, 5)), (WIDTH, WIDTH, (3, 5)), (WIDTH, WIDTH, (3, 5)), (WIDTH, RETURNS, (1, 1))]
        self.layers = torch.nn.ModuleList(torch.nn.Conv2d(*size) for size in sizes)

    def forward(self, image):
        for layer in self.layers:
            rows, columns = (size // 2 for size in layer.kernel_size)
            image = torch.nn.functional.pad(image, (columns, columns, 0, 0), mode="circular") if columns else image
            image = layer(torch.nn.functional.pad(image, (0, 0, rows, rows)))
            image = torch.relu(image) if layer is not self.layers[-1] else image
        return image


def image_of(frame, before):
    """(inputs x channels x columns, the point of each place of RETURNS x channels x columns, -1 without one)."""
    beam = frame.beam[frame.order]
    last = np.searchsorted(beam, beam, "right") - 1 - np.arange(len(beam))  # 0: the last of its beam
    kept = last < RETURNS
    point = frame.order[kept]
    place = last[kept], frame.row[point], frame.column[point]
    points = np.full((RETURNS, len(frame.levels), frame.columns), -1)
    points[place] = point
    values = np.column_stack([np.ones(len(frame.range)), np.log10(frame.range + 1.0) - 2.0, filters.log_amplitude(frame.amplitude) / 2.0 + 1.5,
                              filters.of_history(frame, before)[:, :2]])
    image = np.zeros((values.shape[1], *points.shape), np.float32)
    image[(slice(None), *place)] = values[point].T
    return image.reshape(-1, *points.shape[1:]), points


def inputs_of(kind):
    """Which inputs a kind of network has: the last two of the five of a return are those of time."""
    return list(range((3 if kind.endswith("one-scan") else 5) * RETURNS))


def training(home, number):
    """(image, 1 for birds, weight of each place) of the scans of a sequence."""
    for name, frame, before in filters.frames(home, number):
        if before:
            image, points = image_of(frame, before)
            label = np.append(filters.labels(home, number, name), 0)[points]
            yield image, (label == filters.BIRD).astype(np.float32), ((points >= 0) & ~np.isin(label, filters.MOVING)).astype(np.float32)


def learn(scans, kind, seed, seconds):
    """A network that has learned the scans for so long, with crops of them; in half of them there are birds."""
    torch.manual_seed(seed)
    draw, inputs = np.random.default_rng(seed), inputs_of(kind)
    network = Network(len(inputs))
    steps = torch.optim.Adam(network.parameters(), lr=3e-3)
    end, columns = time.process_time() + seconds, scans[0][0].shape[2]
    while time.process_time() < end:
        crops = []
        for k in range(BATCH):
            image, birds, weights = scans[draw.integers(len(scans))]
            there = np.flatnonzero(birds.any(axis=(0, 1)))
            first = draw.choice(there) - draw.integers(CROP) if k % 2 and len(there) else draw.integers(columns)
            around = (first + np.arange(CROP)) % columns
            crop = image[inputs][:, :, around]
            for part, most in ((slice(RETURNS, 2 * RETURNS), SCALES[0]), (slice(2 * RETURNS, 3 * RETURNS), SCALES[1])):
                crop[part] += draw.uniform(-most, most) * crop[:RETURNS]  # where there are points
            crops.append([crop, birds[:, :, around], weights[:, :, around]])
        image, birds, weights = (torch.from_numpy(np.stack(part)) for part in zip(*crops))
        for group in steps.param_groups:  # falls to a hundredth
            group["lr"] = 3e-3 * 0.01 ** max(0.0, 1.0 - (end - time.process_time()) / seconds)
        loss = torch.nn.functional.binary_cross_entropy_with_logits(network(image), birds, weights, reduction="sum") / weights.sum()
        steps.zero_grad()
        loss.backward()
        steps.step()
    return network.eval()


def scores_of_scan(network, kind, frame, before):
    """A score for each point of a scan."""
    image, points = image_of(frame, before)
    scores = np.full(len(frame.range), NEVER)
    with torch.no_grad():
        scores[points[points >= 0]] = network(torch.from_numpy(image[inputs_of(kind)][None]))[0].numpy()[points >= 0]
    return scores


@filters.baseline(argument("--seconds", type=float, default=SECONDS,
                           help=f"of the processor, to learn a model, default {SECONDS:g}; there are ten"))
def main(options):
    torch.set_num_threads(1)
    models = {}
    for number, parts in filters.without_one(filters.learned(options.sets, lambda *of: list(training(*of)))):
        for kind in KINDS:
            models[kind, number] = learn([scan for part in parts for scan in part], kind, int(number), options.seconds)

    def scores_of(home, number):
        for name, frame, before in filters.frames(home, number):
            yield name, [scores_of_scan(models[kind, number], kind, frame, before) for kind in KINDS]
    filters.predict(options.sets, options.out, KINDS, scores_of)

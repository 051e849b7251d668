# SPDX-License-Identifier: BSD-3-Clause
"""Tables of Fig. 9 to 11 and of Sec. 5.2 and 5.3: what the paper says, what is measured, and a verdict that follows
from the numbers. A ratio within NOTHING of 1 is no difference."""
import functools
import math
from typing import NamedTuple

from results import columns_of, count, fit, pivot as pivoted, read, seconds, table

NOTHING = 1.1
SAME, PARTLY, CONTRADICTED = "same", "**in part**", "**contradicted**"
ORIGINAL, DIRECT = "original ray tracing", "one reflection"
PAPER_RATIOS = {"corridor": ("130/83", 130 / 83), "Hongqiao, 16 channels": ("1439/1122", 1439 / 1122),
                "Hongqiao, 32 channels": ("1831/1633", 1831 / 1633)}


def is_sphere(row):
    return row["scene"].startswith("sphere")


def name_of(row):
    """A sphere is named by its triangles."""
    return f"sphere, {count(row['triangles'])}" if is_sphere(row) else row["scene"]


def pivot(rows, group, values):
    """{scene: {group: values of the row}}, in the order of the rows."""
    return pivoted(rows, name_of, group, lambda r: tuple(r[v] for v in values) if len(values) > 1 else r[values[0]])


def triangles_of(rows):
    return {name_of(r): int(r["triangles"]) for r in rows}


def verdict_of(holds, names, because=""):
    """Of a statement about several cases, with the number of those where it holds."""
    word = SAME if all(holds) else PARTLY if any(holds) else CONTRADICTED
    return f"{word}: {sum(holds)} of {len(holds)} {names}" + ("" if all(holds) or not because else f", because {because}")


def noticed(ratios):
    return f"{sum(r > NOTHING for r in ratios)} of {len(ratios)}"


def in_proportion(power, ruled):
    """Of the growth of a sum: everywhere, where the part that grows so rules, or nowhere."""
    if 0.9 < power < 1.2:
        return SAME
    return f"{PARTLY if 0.9 < ruled < 1.2 else CONTRADICTED}, because detection grows more slowly than the mesh"


def split(scenes):
    """Spheres in order, and the others."""
    return [s for s in scenes if s.startswith("sphere")], [s for s in scenes if not s.startswith("sphere")]


def span(values):
    values = list(values)
    return f"{min(values):.2f} to {max(values):.2f}" if values else "-"


def percent(share):
    return "0" if share <= 0.0 else "100 %" if share >= 0.995 else f"{100 * share:.2g} %"


# ---------------------------------------------------------------------------------------------- Fig. 9

BVH, KD = ("BVH", "AABB"), ("k-D", "AABB")
BVH_SBV, KD_SBV = ("BVH", "SBV"), ("k-D", "SBV")
OF_PAPER = (KD, KD_SBV, BVH, BVH_SBV)


def trees(folder):
    """{scene: {(rule, volume): (build, detection, total)}}"""
    return pivot(read(folder, "figure9"), lambda r: (r["split_rule"].split()[0], r["volume"]),
                 ("build_s", "detection_s", "total_s"))


def figure9(folder):
    found, triangles = trees(folder), triangles_of(read(folder, "figure9"))
    names = [f"{rule}, {volume}" for rule, volume in OF_PAPER]
    rows = [[scene, count(triangles[scene]), *(" + ".join(map(seconds, t[key][:2])) + " = " + seconds(t[key][2])
                                               if key in t else "-" for key in OF_PAPER)]
            for scene, t in found.items()]
    return table(["scene", "triangles", *names], rows)


def work9(folder):
    """Nodes met and triangles tested by a beam, of the paper's four trees."""
    found = pivot(read(folder, "figure9"), lambda r: (r["split_rule"].split()[0], r["volume"]), ("nodes", "tests"))
    return table(["scene", *(f"{rule}, {volume}" for rule, volume in OF_PAPER)],
                 [[scene, *(f"{t[key][0]:,.0f}; {t[key][1]:,.1f}" if key in t else "-" for key in OF_PAPER)]
                  for scene, t in found.items()])


def paper9(folder):
    found, triangles = trees(folder), triangles_of(read(folder, "figure9"))
    full = [s for s in found if set(OF_PAPER) <= found[s].keys()]
    spheres, others = split(full)
    if len(spheres) < 2:
        return ""
    large = [s for s in spheres if triangles[s] >= 2000] or spheres

    def power(part, key=KD, scenes=large):
        return fit([math.log(triangles[s]) for s in scenes], [math.log(found[s][key][part]) for s in scenes])[0] if scenes else math.nan

    def ratios(a, b, part, scenes):
        return [found[s][a][part] / found[s][b][part] for s in scenes]

    def text(part, *pairs):
        """Ratios of pairs of trees, on spheres and on the other scenes."""
        return "; ".join(f"{name}: " + ", ".join(f"{words} {span(ratios(a, b, part, scenes))}" for words, scenes in (
            ("spheres", spheres), ("others", others)) if scenes) for name, a, b in pairs)

    sbv = (("BVH", BVH_SBV, BVH), ("k-D", KD_SBV, KD))
    rules = (("AABB", BVH, KD), ("SBV", BVH_SBV, KD_SBV))

    def won(part, pairs):
        return [r > 1.0 for _, a, b in pairs for r in ratios(a, b, part, full)]

    rays = max(r["rays"] for r in read(folder, "figure9"))
    build, detection, total = (power(part) for part in range(3))
    ruled = power(2, scenes=[s for s in large if found[s][KD][0] > found[s][KD][1]])
    first, last = ([found[s][b][2] / found[s][a][2] for a, b in ((BVH, BVH_SBV), (KD, KD_SBV))]
                   for s in (spheres[0], spheres[-1]))
    grows = all(x > NOTHING * y for x, y in zip(last, first))
    wins = [min(OF_PAPER, key=lambda key, s=s: found[s][key][2]) for s in full]

    return table(["the paper says", "measured here", "verdict"], [
        ["building takes time in proportion to the number of triangles",
         f"k-D with AABB, spheres from {count(triangles[large[0]])}: as n^{build:.2f}",
         SAME if 0.9 < build < 1.2 else f"{CONTRADICTED}, because sorting takes n log n"],
        ["so does the total", f"detection as n^{detection:.2f}, total as n^{total:.2f} with {rays:,.0f} rays; "
         f"where building takes longer than detection, as n^{ruled:.2f}", in_proportion(total, ruled)],
        ["so does the total with SBV", f"k-D as n^{power(2, KD_SBV):.2f}, BVH as n^{power(2, BVH_SBV):.2f}",
         in_proportion(min(power(2, KD_SBV), power(2, BVH_SBV)), 0.0)],
        *[[f"with SBV the {word} time is higher throughout than with AABB", f"SBV over AABB, {text(part, *sbv)}",
           verdict_of(won(part, sbv), "cases", because)]
          for part, (word, because) in enumerate((
              ("building", ""),
              ("detection", "a cone is tested against a sphere by one comparison and against a box by up to five; only where "
               "triangles are flat and of many sizes are so many more spheres met that boxes win"),
              ("total", "spheres are slower to fit, which decides only where triangles are many")))],
        ["and grows much faster", "total, SBV over AABB: BVH {:.2f}, k-D {:.2f} at {} triangles; {:.2f} and {:.2f} at {}"
         .format(*first, count(triangles[spheres[0]]), *last, count(triangles[spheres[-1]])),
         SAME if grows else f"{CONTRADICTED}, because the parts grow alike"],
        *[[f"with the same volume the k-D tree is more efficient than the BVH: {word}",
           f"BVH over k-D, {text(part, *rules)}", verdict_of(won(part, rules), "cases", because)]
          for part, (word, because) in enumerate((
              ("building", "halves of the list need no sorting"),
              ("detection", "a mesh lists neighbouring triangles together, so halves of a building's list are compact, too"),
              ("total", "it is slower to build")))],
        ["AABB with the k-D tree is the best of the four", "least total: " + ", ".join(
            f"{' with '.join(key)} in {wins.count(key)}" for key in OF_PAPER if key in wins) + f" of {len(full)} scenes",
         verdict_of([key == KD for key in wins], "scenes", "spheres win where detection decides, the BVH where building does")],
    ], words=True)


# ---------------------------------------------------------------------------------------------- two trees

TREES = {"eight": "eight boxes a node", "two": "two boxes a node (preset Paper)"}  # the preset's comes last


class Ratio(NamedTuple):
    """Of two times in the same turns: median, least and largest."""
    median: float
    least: float
    most: float

    @property
    def text(self):
        return f"{self.median:,.2f} ({self.least:,.2f} to {self.most:,.2f})"


def on(folder, name, boxes):
    """The rows of one file that were measured on one tree."""
    return [r for r in read(folder, name) if r["boxes"] == boxes]


def ratios_of(folder, name, boxes, group):
    return pivoted(on(folder, name, boxes), name_of, group, lambda r: Ratio(r["ratio"], r["least"], r["most"]))


def turns(ratios):
    """The span of all turns of several ratios."""
    ratios = list(ratios)
    return span([r.least for r in ratios] + [r.most for r in ratios])


def on_both(rows_of, folder, *columns):
    """A table of claims: what is measured on each tree, and the verdict."""
    by = [rows_of(folder, boxes) for boxes in TREES]
    if not all(by):
        return ""
    rows = [[*alike[0][:-2], *(cell for row in alike for cell in row[-2:])] for alike in zip(*by)]
    return table(["the paper says", *columns, *(word for tree in TREES.values() for word in (tree, "verdict"))], rows,
                 words=True)


# ---------------------------------------------------------------------------------------------- Fig. 10

def methods(folder, boxes="two"):
    """{scene: {method: (scan, total)}}"""
    return pivot(on(folder, "figure10", boxes), lambda r: r["method"], ("scan_s", "total_s"))


def figure10(folder, part):
    """Times; of scans also the ratios to the proposed method."""
    triangles = triangles_of(read(folder, "figure10"))
    run = pivot(on(folder, "figure10", "two"), lambda r: r["method"], ("run_beams",))
    names = columns_of(methods(folder))
    rows = []
    for boxes in TREES:
        ratios = ratios_of(folder, "figure10", boxes, lambda r: r["method"])
        for scene, t in methods(folder, boxes).items():
            rows.append([scene, count(triangles[scene]), boxes, *(
                "-" if m not in t else seconds(t[m][part]) + ("; " + ratios[scene][m].text) * (part == 0 and m != "proposed")
                for m in names), f"{count(run[scene].get('facet loop, Phong', 0))}, "
                f"{count(run[scene]['facet loop, one reflection, Phong'])} of {count(run[scene]['proposed'])}"])
    return table(["scene", "triangles", "boxes a node", *names, "beams run by facet loops"], rows)


PEERS = ("facet loop, one reflection", "facet loop", "per ray")
ONE_BY_ONE = "the peer tests the rays of its second reflections one by one against all triangles"
PER_RAY = "the peer descends the same tree a hundred times a beam"
FOOTPRINT = ("batch tests a beam's rays against every triangle of its cone, front and back, whose number grows with the mesh; "
             "a single ray meets a few")


def claims10(folder, boxes):
    """(claim, peer, measured, verdict)"""
    found, triangles = methods(folder, boxes), triangles_of(read(folder, "figure10"))
    scans = ratios_of(folder, "figure10", boxes, lambda r: r["method"])
    spheres, others = split(found)
    if len(spheres) < 2:
        return []
    few = [s for s in spheres if triangles[s] <= 300]

    def in_turns(peer, scenes):
        """Scans of the peer over proposed, of both models."""
        return [scans[s][f"{peer}, {m}"] for s in scenes for m in ("Phong", "BRDF")]

    def ratios(peer, scenes, part):
        """Part 0: scan, 1: build and scan."""
        if part == 0:
            return [r.median for r in in_turns(peer, scenes)]
        return [found[s][f"{peer}, {m}"][1] / found[s]["proposed"][1] for s in scenes for m in ("Phong", "BRDF")]

    rows = []
    for peer, because in zip(PEERS, ("from about a hundred triangles on a descent takes less than testing all of them", ONE_BY_ONE, PER_RAY)):
        rows.append(["with few triangles the proposed method takes more time", peer, "peer / proposed: " + "; ".join(
            f"{' and '.join(r.text for r in in_turns(peer, [s]))} at {count(triangles[s])}" for s in few),
            verdict_of([x < 1.0 for s in few for x in ratios(peer, [s], 0)], "cases", because)])
    growing, advantage = [], []
    for peer in PEERS:
        known = [s for s in spheres if f"{peer}, Phong" in found[s] and triangles[s] >= 100]
        first, last = known[0], known[-1]
        words = f"from {count(triangles[first])} to {count(triangles[last])} triangles"
        ours = [found[last]["proposed"][part] / found[first]["proposed"][part] for part in (0, 1)]
        theirs = [[found[last][f"{peer}, {m}"][part] / found[first][f"{peer}, {m}"][part] for m in ("Phong", "BRDF")]
                  for part in (0, 1)]
        growing.append([
            "its time grows at a significantly lower rate", peer,
            f"{words}: proposed {ours[0]:,.1f} times, Phong {theirs[0][0]:,.1f}, BRDF {theirs[0][1]:,.1f}; with build "
            f"{ours[1]:,.1f}, {theirs[1][0]:,.1f}, {theirs[1][1]:,.1f}",
            verdict_of([x > NOTHING * ours[part] for part in (0, 1) for x in theirs[part]], "cases", FOOTPRINT)])
        ends = [(ratios(peer, [first], part), ratios(peer, [last], part)) for part in (0, 1)]
        rest = [s for s in others if f"{peer}, Phong" in found[s]]
        low, high = in_turns(peer, [first]), in_turns(peer, [last])
        advantage.append([
            "so its advantage increases", peer,
            f"{words}, peer / proposed: Phong {low[0].text} to {high[0].text}, BRDF {low[1].text} to {high[1].text}; with "
            f"build {ends[1][0][0]:.2f} to {ends[1][1][0]:,.2f}, {ends[1][0][1]:.2f} to {ends[1][1][1]:,.2f}"
            + (f"; other scenes {turns(in_turns(peer, rest))}" if rest else ""),
            verdict_of([y > NOTHING * x for first, last in ends for x, y in zip(first, last)], "cases", FOOTPRINT)])
    superior = []
    for words, scenes in (("in complex scenes it is faster", others),
                          ("with 100,000 triangles and more it is faster", [s for s in found if triangles[s] >= 1e5])):
        for peer in PEERS:
            known = [s for s in scenes if f"{peer}, Phong" in found[s]]
            scan, built = (ratios(peer, known, part) for part in (0, 1))
            if scan:
                superior.append([words, peer, f"peer / proposed, both models: {turns(in_turns(peer, known))}, noticeably in "
                                 f"{noticed(scan)}; with build {span(built)}, noticeably in {noticed(built)}",
                                 verdict_of([r > NOTHING for r in scan + built], "cases", FOOTPRINT)])
    return [*rows, *growing, *advantage, *superior]


def paper10(folder):
    return on_both(claims10, folder, "peer")


# ---------------------------------------------------------------------------------------------- Fig. 11

READINGS = {"energy": "Qlow", "energy/N": "Qlow/N"}  # what a path is compared with
PRESET = "energy"                                    # the reading of preset Paper
BEAM_COSTS = ("where a cone meets hundreds of triangles the search among them takes as long as the rays that it saves; elsewhere few "
              "beams have second rays")
NO_SECOND = "where no second ray is traced on there is none to leave out"
FEW_LEFT = "few second rays are left that the other could spare"
LIFTED = "paths with two reflections, too faint each, lift range units above the limit whose direct light is just below it"


def figure11(folder):
    """Times, and original ray tracing over them."""
    triangles = triangles_of(read(folder, "figure11"))
    rows, names = [], []
    for boxes in TREES:
        found = pivot(on(folder, "figure11", boxes), lambda r: r["switches"], ("best_s",))
        ratios = ratios_of(folder, "figure11", boxes, lambda r: r["switches"])
        names = columns_of(found)
        rows += [[scene, count(triangles[scene]), boxes,
                  *(seconds(t[m]) + ("; " + ratios[scene][m].text) * (m != ORIGINAL) for m in names)] for scene, t in found.items()]
    return table(["scene", "triangles", "boxes a node", *names], rows)


def paths(folder):
    """{switches: {scene: row}} of what came after the first reflection."""
    rows = read(folder, "rays11")
    return {k: {name_of(r): r for r in rows if r["switches"] == k} for k in (ORIGINAL, *READINGS)}


def over_two(row):
    """The share of the energy that came after two reflections."""
    return row["second_energy_j"] / row["energy_j"]


def rays11(folder):
    """Rays traced on from the first reflection, the share of energy that they bring, and what the constraint costs."""
    rays = pivot(read(folder, "rays11"), lambda r: r["switches"], ("second_rays",))
    kept = paths(folder)
    first = kept[ORIGINAL]
    names = (ORIGINAL, "energy", "energy/N", "share", "beam", "beam + energy", "beam + energy/N")
    return table(["scene", *names, "energy of echoes by two reflections", *(f"{word} {limit}" for limit in READINGS.values() for word in (
        "of it left by", "range units lost by", "energy lost by"))],
                 [[s, *(count(r[k]) for k in names), f"{100 * over_two(first[s]):.3g} %",
                   *(text for reading in READINGS for text in (f"{100 * over_two(kept[reading][s]):.3g} %", *(
                       percent(max(0.0, 1.0 - kept[reading][s][k] / first[s][k])) for k in ("echoes", "energy_j"))))]
                  for s, r in rays.items()])


def losses(folder, reading):
    """Shares of range units and of energy that the constraint costs, of each scene where there is anything to lose."""
    kept = paths(folder)
    first = kept[ORIGINAL]
    return [[1.0 - kept[reading][s][k] / first[s][k] for s in first if over_two(first[s]) > 0.0] for k in ("echoes", "energy_j")]


def claims11(folder, boxes, energy):
    """(claim, measured, verdict) with one reading of the light-energy constraint."""
    ratios = ratios_of(folder, "figure11", boxes, lambda r: r["switches"])
    spheres, others = split(ratios)
    if len(spheres) < 2:
        return []
    every = [*spheres, *others]
    singles = ("beam", energy, "batch")
    pairs = (f"beam + {energy}", "beam + batch", f"{energy} + batch")
    both = f"beam + {energy} + batch"
    # Times in those of original ray tracing.
    found = {s: {k: 1.0 / ratios[s][k].median for k in (ORIGINAL, *singles, *pairs, both, DIRECT)} for s in every}

    def gains(name, scenes=every):
        return [ratios[s][name].median for s in scenes]

    def best(names, scene):
        return min(names, key=lambda n: found[scene][n])

    def best_text(name):
        return ", ".join(f"{words} {turns(ratios[s][name] for s in scenes)}" for words, scenes in (
            ("spheres", spheres), ("others", others)) if scenes)

    rays = pivot(read(folder, "rays11"), lambda r: r["switches"], ("second_rays",))

    def saves(name, scene):
        """Whether the light-energy constraint saves any rays worth a mention; all else is noise."""
        names = ("beam", f"beam + {energy}") if "beam" in name else (ORIGINAL, energy)
        saved = rays[scene][names[0]] - rays[scene][names[1]]
        return "energy" not in name or saved > 0.01 * rays[scene][ORIGINAL]

    direct = [found[s][energy] / found[s][DIRECT] for s in every]
    beside = {energy: f"; this / original with one reflection: {span(direct)}"}
    rows = [[f"the {words} alone lowers the time noticeably", f"original / {name}: {best_text(name)}{beside.get(name, '')}",
             verdict_of([g > NOTHING and saves(name, s) for s, g in zip(every, gains(name))], "scenes", because)]
            for name, words, because in (("beam", "beam constraint", BEAM_COSTS), (energy, "light-energy constraint", NO_SECOND),
                                         ("batch", "batch", FOOTPRINT))]
    triangles = triangles_of(read(folder, "figure11"))
    few = [s for s in spheres if triangles[s] <= 1000]
    rows.append(["with few triangles batch is the best of the three", "; ".join(
        f"{s}: best is {best(singles, s)}" for s in few), verdict_of([best(singles, s) == "batch" for s in few], "spheres",
                                                                               "the beam constraint saves more")])
    many = [s for s in spheres if triangles[s] >= 1e6] or spheres[-1:]
    rows.append(["with many the beam constraint is faster than batch", "; ".join(
        f"{s}: original / beam {ratios[s]['beam'].text}, / batch {ratios[s]['batch'].text}" for s in many),
        verdict_of([found[s]["beam"] < found[s]["batch"] for s in many], "spheres", "batch saves more")])
    kept = paths(folder)
    left = [percent(max(map(over_two, kept[k].values()))) for k in (ORIGINAL, energy)]
    units, joule = losses(folder, energy)
    rows.append(["the three do not compromise the resolution of the cloud", "beam constraint and batch: not a bit of any echo; light-energy "
                 f"constraint, where anything comes after two reflections: range units lost {span(100 * u for u in units)} %, energy "
                 f"{span(100 * e for e in joule)} %; after two reflections come up to {left[0]} of the energy without it and {left[1]} with it",
                 verdict_of([True, True, max(units, default=0.0) <= 0.0], "accelerations", LIFTED)])
    for name, because in zip(pairs, (FEW_LEFT, FOOTPRINT, FOOTPRINT)):
        parts = name.split(" + ")
        faster = [found[s][best(parts, s)] / found[s][name] for s in every]
        rows.append([f"{name.replace('/N', '')} together are faster than either alone", f"the better of the two / both: {span(faster)}",
                     verdict_of([f > NOTHING and saves(name, s) for s, f in zip(every, faster)], "scenes", because)])
    other = [min(found[s][p] for p in pairs if p != "beam + batch") / found[s]["beam + batch"] for s in every]
    rows.append(["the best pair is beam constraint with batch", f"the best other pair / this pair: {span(other)}",
                 verdict_of([p > 1.0 for p in other], "scenes",
                            f"{FEW_LEFT}; so energy with batch is faster")])
    rest = [found[s][best([k for k in found[s] if k not in (both, DIRECT)], s)] / found[s][both] for s in every]
    rows.append(["all three are the fastest",
                 f"original / all three {best_text(both)}; the best of the others / all three {span(rest)}, noticeably in "
                 f"{noticed(rest)}",
                 verdict_of([r > 1.0 / NOTHING for r in rest], f"scenes, within {100 * NOTHING - 100:.0f} %", FOOTPRINT)])
    rows.append(["all three are faster than original ray tracing", f"original / all three {best_text(both)}",
                 verdict_of([g > NOTHING for g in gains(both)], "scenes", FOOTPRINT)])
    rows.append(["with many triangles the beam constraint lowers the time noticeably", "original / beam: " + "; ".join(
        f"{s}: {ratios[s]['beam'].text}" for s in many), verdict_of([g > NOTHING for g in gains("beam", many)], "spheres", BEAM_COSTS)])
    return rows


def paper11(folder):
    """With the preset's reading first. Verdicts of the other begin with what its paths are compared with."""
    def rows_of(results, boxes):
        other = [reading for reading in READINGS if reading != PRESET]
        return [*claims11(results, boxes, PRESET), *([f"{READINGS[reading]}: {row[0]}", *row[1:]] for reading in other
                                                    for row in claims11(results, boxes, reading))]
    return on_both(rows_of, folder)


# ---------------------------------------------------------------------------------------------- epsilon

def epsilon(folder):
    """What choices cost and lose, each beside the constraint off."""
    rows = []
    for scene, choices in pivoted(read(folder, "epsilon"), name_of, lambda r: r["choice"], dict).items():
        off = choices["off"]
        for r in choices.values():
            lost = [max(0.0, 1.0 - r[k] / off[k]) for k in ("energy_j", "echoes")]
            rows.append([scene, r["choice"], f"{r['fraction']:g}" if r["fraction"] else "-", seconds(r["best_s"]),
                         f"{off['best_s'] / r['best_s']:.2f}", count(r["second_rays"]),
                         *(percent(x) for x in lost)])
    return table(["scene", "epsilon", "LightEnergyFraction", "time", "off / this", "rays after the first reflection",
                  "energy lost", "echoes lost"], rows)


# ---------------------------------------------------------------------------------------------- Sec. 5.2 and 5.3

def section5(folder):
    rows = []
    for boxes in TREES:
        scenes = pivoted(on(folder, "section5", boxes), lambda r: (r["scene"], r["triangles"], r["beams"]), lambda r: r["method"], dict)
        for (scene, triangles, beams), methods_of in scenes.items():
            original, proposed, ours = methods_of.values()
            ratio, usual = (Ratio(r["ratio"], r["least"], r["most"]) for r in (proposed, ours))
            built = (original["build_s"] + original["scan_s"]) / (proposed["build_s"] + proposed["scan_s"])
            words, value = PAPER_RATIOS.get(scene, ("", 0.0))
            rows.append([scene, count(triangles), count(beams), boxes, seconds(original["build_s"]), seconds(original["scan_s"]),
                         seconds(proposed["scan_s"]), ratio.text, f"{built:.2f}", f"{words} = {value:.2f}" if words else "-",
                         (SAME + ", larger" if ratio.median > NOTHING * value else SAME) if words and ratio.median > NOTHING
                         else CONTRADICTED if words else "-", seconds(ours["scan_s"]), usual.text, *(f"{r['held_mib']:.1f} MiB" for r in (original, proposed))])
    return table(["scene", "triangles", "beams", "boxes a node", "build", "original", "proposed", "original / proposed", "with build",
                  "the paper (ms)", "verdict: faster", "defaults of this project", "original / defaults", "memory of the scan, original",
                  "proposed"], rows)


TABLES = {"figure9": figure9, "work9": work9, "paper9": paper9,
          "figure10": functools.partial(figure10, part=0), "figure10-build": functools.partial(figure10, part=1),
          "paper10": paper10, "figure11": figure11, "rays11": rays11, "paper11": paper11, "epsilon": epsilon,
          "section5": section5}

# SPDX-License-Identifier: BSD-3-Clause
"""Tables of Fig. 9 to 11 and of Sec. 5.2 and 5.3: what the paper says, what is measured, and a verdict that follows
from the numbers. A ratio within NOTHING of 1 is no difference."""
import functools
import math

from results import columns_of, count, fit, pivot as pivoted, read, seconds, table

NOTHING = 1.1
SAME, PARTLY, CONTRADICTED = "same", "**in part**", "**contradicted**"
ORIGINAL, ALL, DIRECT = "original ray tracing", "beam + energy + batch", "one reflection"
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


# ---------------------------------------------------------------------------------------------- Fig. 10

def methods(folder):
    """{scene: {method: (scan, total)}}"""
    return pivot(read(folder, "figure10"), lambda r: r["method"], ("scan_s", "total_s"))


def figure10(folder, part):
    found, triangles = methods(folder), triangles_of(read(folder, "figure10"))
    run = pivot(read(folder, "figure10"), lambda r: r["method"], ("run_beams",))
    names = columns_of(found)
    rows = [[scene, count(triangles[scene]), *(seconds(t[m][part]) if m in t else "-" for m in names),
             f"{count(run[scene].get('facet loop, Phong', 0))}, "
             f"{count(run[scene]['facet loop, one reflection, Phong'])} of {count(run[scene]['proposed'])}"]
            for scene, t in found.items()]
    return table(["scene", "triangles", *names, "beams run by facet loops"], rows)


PEERS = ("facet loop, one reflection", "facet loop", "per ray")
ONE_BY_ONE = "the peer tests the rays of its second reflections one by one against all triangles"
PER_RAY = "the peer descends the same tree a hundred times a beam"
FOOTPRINT = ("batch tests a beam's rays against every triangle of its cone, front and back, whose number grows with the mesh; "
             "a single ray meets a few")


def paper10(folder):
    found, triangles = methods(folder), triangles_of(read(folder, "figure10"))
    spheres, others = split(found)
    if len(spheres) < 2:
        return ""
    few = [s for s in spheres if triangles[s] <= 300]

    def ratios(peer, scenes, part):
        """Peer over proposed, of both models; part 0: scan, 1: build and scan."""
        return [found[s][f"{peer}, {m}"][part] / found[s]["proposed"][part] for s in scenes for m in ("Phong", "BRDF")]

    rows = []
    for peer, because in zip(PEERS, ("from about a hundred triangles on a descent takes less than testing all of them", ONE_BY_ONE, PER_RAY)):
        values = [ratios(peer, [s], 0) for s in few]
        rows.append(["with few triangles the proposed method takes more time", peer, "peer / proposed: " + "; ".join(
            f"{v[0]:.2f} and {v[1]:.2f} at {count(triangles[s])}" for s, v in zip(few, values)),
            verdict_of([x < 1.0 for v in values for x in v], "cases", because)])
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
        advantage.append([
            "so its advantage increases", peer,
            f"{words}, peer / proposed: Phong {ends[0][0][0]:.2f} to {ends[0][1][0]:,.2f}, BRDF {ends[0][0][1]:.2f} to "
            f"{ends[0][1][1]:,.2f}; with build {ends[1][0][0]:.2f} to {ends[1][1][0]:,.2f}, {ends[1][0][1]:.2f} to "
            f"{ends[1][1][1]:,.2f}" + (f"; other scenes {span(ratios(peer, rest, 0))}" if rest else ""),
            verdict_of([y > NOTHING * x for first, last in ends for x, y in zip(first, last)], "cases", FOOTPRINT)])
    superior = []
    for words, scenes in (("in complex scenes it is faster", others),
                          ("with 100,000 triangles and more it is faster", [s for s in found if triangles[s] >= 1e5])):
        for peer in PEERS:
            known = [s for s in scenes if f"{peer}, Phong" in found[s]]
            values = [r for part in (0, 1) for r in ratios(peer, known, part)]
            if values:
                superior.append([words, peer, f"peer / proposed, both models, with and without build: {span(values)}",
                                 verdict_of([r > NOTHING for r in values], "cases", FOOTPRINT)])
    # The proposed method has no path with two reflections left; so have rays one by one in the ablation.
    ablation = switches(folder)
    if ablation:
        for words, scenes in (("in complex scenes it is faster", others),
                              ("with 100,000 triangles and more it is faster", [s for s in found if triangles[s] >= 1e5])):
            values = [ablation[s][DIRECT] / ablation[s][ALL] for s in scenes]
            if values:
                superior.append([words, "per ray, one reflection", f"peer / proposed, of Fig. 11: {span(values)}",
                                 verdict_of([v > NOTHING for v in values], "cases", FOOTPRINT)])
    return table(["the paper says", "peer", "measured here", "verdict"], [*rows, *growing, *advantage, *superior], words=True)


# ---------------------------------------------------------------------------------------------- Fig. 11

SINGLES, PAIRS = ("beam", "energy", "batch"), ("beam + energy", "beam + batch", "energy + batch")


BEAM_COSTS = ("where a cone meets hundreds of triangles the search among them takes as long as the rays that it saves; elsewhere few "
              "beams have second rays")
NO_SECOND = "where no second ray is traced on there is none to leave out"
FEW_LEFT = "with the paper's threshold few second rays are left that the beam constraint could spare"
LIFTED = "paths with two reflections, too faint each, lift range units above the limit whose direct light is just below it"


def switches(folder):
    return pivot(read(folder, "figure11"), lambda r: r["switches"], ("best_s",))


def figure11(folder):
    found, triangles = switches(folder), triangles_of(read(folder, "figure11"))
    names = columns_of(found)
    return table(["scene", "triangles", *names],
                 [[scene, count(triangles[scene]), *(seconds(t[m]) for m in names)] for scene, t in found.items()])


def paths(folder):
    """{scene: row} of original ray tracing, and of the light-energy constraint alone, with the paper's threshold."""
    rows = read(folder, "rays11")
    return [{name_of(r): r for r in rows if r["switches"] == k} for k in (ORIGINAL, "energy")]


def over_two(row):
    """The share of the energy that came after two reflections."""
    return row["second_energy_j"] / row["energy_j"]


def rays11(folder):
    """Rays traced on from the first reflection, the share of energy that they bring, and what the constraint costs."""
    rays = pivot(read(folder, "rays11"), lambda r: r["switches"], ("second_rays",))
    first, kept = paths(folder)
    return table(["scene", "neither", "energy", "share", "beam", "beam + energy", "energy of echoes by two reflections", "of it left by energy",
                  "range units lost by energy", "energy lost"],
                 [[s, *(count(r[k]) for k in (ORIGINAL, "energy", "share", "beam", "beam + energy")),
                   *(f"{100 * over_two(one[s]):.3g} %" for one in (first, kept)),
                   *(percent(max(0.0, 1.0 - kept[s][k] / first[s][k])) for k in ("echoes", "energy_j"))] for s, r in rays.items()])


def losses(folder):
    """Shares of range units and of energy that the constraint with the paper's threshold costs, of each scene where there is
    anything to lose."""
    first, kept = paths(folder)
    return [[1.0 - kept[s][k] / first[s][k] for s in first if over_two(first[s]) > 0.0] for k in ("echoes", "energy_j")]


def paper11(folder):
    found = switches(folder)
    spheres, others = split(found)
    if len(spheres) < 2:
        return ""
    every = [*spheres, *others]

    def gains(name, scenes=every):
        return [found[s][ORIGINAL] / found[s][name] for s in scenes]

    def best(names, scene):
        return min(names, key=lambda n: found[scene][n])

    def best_text(name):
        return f"spheres {span(gains(name, spheres))}, others {span(gains(name, others))}" if others else span(gains(name))

    rays = pivot(read(folder, "rays11"), lambda r: r["switches"], ("second_rays",))

    def saves(name, scene):
        """Whether the light-energy constraint saves any rays worth a mention; all else is noise."""
        names = ("beam", "beam + energy") if "beam" in name else (ORIGINAL, "energy")
        saved = rays[scene][names[0]] - rays[scene][names[1]]
        return "energy" not in name or saved > 0.01 * rays[scene][ORIGINAL]

    direct = [found[s]["energy"] / found[s][DIRECT] for s in every]
    beside = {"energy": f"; energy / original with one reflection: {span(direct)}"}
    rows = [[f"the {words} alone lowers the time noticeably", f"original / {name}: {best_text(name)}{beside.get(name, '')}",
             verdict_of([g > NOTHING and saves(name, s) for s, g in zip(every, gains(name))], "scenes", because)]
            for name, words, because in (("beam", "beam constraint", BEAM_COSTS), ("energy", "light-energy constraint", NO_SECOND),
                                         ("batch", "batch", FOOTPRINT))]
    triangles = triangles_of(read(folder, "figure11"))
    few = [s for s in spheres if triangles[s] <= 1000]
    rows.append(["with few triangles batch is the best of the three", "; ".join(
        f"{s}: best is {best(SINGLES, s)}" for s in few), verdict_of([best(SINGLES, s) == "batch" for s in few], "spheres",
                                                                               "the beam constraint saves more")])
    many = [s for s in spheres if triangles[s] >= 1e6] or spheres[-1:]
    rows.append(["with many the beam constraint is faster than batch", "; ".join(
        f"{s}: original / beam {gains('beam', [s])[0]:.2f}, / batch {gains('batch', [s])[0]:.2f}" for s in many),
        verdict_of([found[s]["beam"] < found[s]["batch"] for s in many], "spheres", "batch saves more")])
    first, kept = paths(folder)
    left = [percent(max(map(over_two, one.values()))) for one in (first, kept)]
    units, energy = losses(folder)
    rows.append(["the three do not compromise the resolution of the cloud", "beam constraint and batch: not a bit of any echo; light-energy "
                 f"constraint, where anything comes after two reflections: range units lost {span(100 * u for u in units)} %, energy "
                 f"{span(100 * e for e in energy)} %; after two reflections come up to {left[0]} of the energy without it and {left[1]} with it",
                 verdict_of([True, True, max(units, default=0.0) <= 0.0], "accelerations", LIFTED)])
    for name, because in zip(PAIRS, (FEW_LEFT, FOOTPRINT, FOOTPRINT)):
        parts = name.split(" + ")
        faster = [found[s][best(parts, s)] / found[s][name] for s in every]
        rows.append([f"{name} together are faster than either alone", f"the better of the two / both: {span(faster)}",
                     verdict_of([f > NOTHING and saves(name, s) for s, f in zip(every, faster)], "scenes", because)])
    pairs = [min(found[s][p] for p in PAIRS if p != "beam + batch") / found[s]["beam + batch"] for s in every]
    rows.append(["the best pair is beam constraint with batch", f"the best other pair / this pair: {span(pairs)}",
                 verdict_of([p > 1.0 for p in pairs], "scenes", f"{FEW_LEFT}; so energy with batch is faster")])
    rest = [found[s][best([k for k in found[s] if k not in (ALL, DIRECT)], s)] / found[s][ALL] for s in every]
    pair = [found[s]["beam + batch"] / found[s][ALL] for s in every]
    rows.append(["all three are the fastest",
                 f"original / all three {best_text(ALL)}; beam + batch / all three {span(pair)}; the best of the others / "
                 f"all three {span(rest)}", verdict_of([r > 1.0 / NOTHING for r in rest], f"scenes, within {100 * NOTHING - 100:.0f} %",
                                                                  FOOTPRINT)])
    rows.append(["all three are faster than original ray tracing", f"original / all three {best_text(ALL)}",
                 verdict_of([g > NOTHING for g in gains(ALL)], "scenes", FOOTPRINT)])
    rows.append(["with many triangles the beam constraint lowers the time noticeably", "original / beam: " + "; ".join(
        f"{s}: {gains('beam', [s])[0]:.2f}" for s in many), verdict_of([g > NOTHING for g in gains("beam", many)], "spheres", BEAM_COSTS)])
    return table(["the paper says", "measured here", "verdict"], rows, words=True)


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
    scenes = pivoted(read(folder, "section5"), lambda r: (r["scene"], r["triangles"], r["beams"]), lambda r: r["method"], dict)
    rows = []
    for (scene, triangles, beams), methods_of in scenes.items():
        original, proposed, ours = methods_of.values()
        ratio = original["scan_s"] / proposed["scan_s"]
        built = (original["build_s"] + original["scan_s"]) / (proposed["build_s"] + proposed["scan_s"])
        words, value = PAPER_RATIOS.get(scene, ("", 0.0))
        rows.append([scene, count(triangles), count(beams), seconds(original["build_s"]), seconds(original["scan_s"]),
                     seconds(proposed["scan_s"]), f"**{ratio:.2f}**", f"{built:.2f}",
                     f"{words} = {value:.2f}" if words else "-",
                     (SAME + ", larger" if ratio > NOTHING * value else SAME) if words and ratio > NOTHING
                     else CONTRADICTED if words else "-",
                     seconds(ours["scan_s"]), f"{original['scan_s'] / ours['scan_s']:.2f}",
                     f"{proposed['scan_s'] / ours['scan_s']:.2f}"])
    return table(["scene", "triangles", "beams", "build", "original", "proposed", "original / proposed", "with build",
                  "the paper (ms)", "verdict: faster", "defaults of this project", "original / defaults",
                  "proposed / defaults"], rows)


TABLES = {"figure9": figure9, "work9": work9, "paper9": paper9,
          "figure10": functools.partial(figure10, part=0), "figure10-build": functools.partial(figure10, part=1),
          "paper10": paper10, "figure11": figure11, "rays11": rays11, "paper11": paper11, "epsilon": epsilon,
          "section5": section5}

# SPDX-License-Identifier: BSD-3-Clause
"""What must the lidar be? The airport's plan by `avianlidar design`: the head of its page as Chromium shows it,
pictures and tables.

    Testing/Studies/run.py design --out build/design
"""
import tools
from avianlidar._command import main as avianlidar
from browser import Browser
from running import AIRPORT, rows_of, study

# Column of design.csv, heading, factor, form.
NUMBERS = (("design", "design", 1, "%d"), ("mast [m]", "mast, m", 1, "%g"),
           ("number_of_channels [1]", "channels", 1, "%d"), ("maximum_elevation [deg]", "to, deg", 1, "%.1f"),
           ("half_beamwidth [rad]", "half beamwidth, mrad", 1e3, "%.1f"),
           ("receiver_aperture [m2]", "aperture, cm²", 1e4, "%.0f"), ("pulse_energy [J]", "pulse, mJ", 1e3, "%.2f"),
           ("rotation_rate [Hz]", "scans/s", 1, "%g"), ("radiant_exposure [J/m2]", "radiant exposure, J/m²", 1, "%.2f"),
           ("pulse_rate [Hz]", "pulses/s", 1, "%.0f"), ("cost [k€]", "cost, k€", 1, "%.1f"))


@study()
def main(options):
    code = avianlidar(["design", str(AIRPORT.parents[2] / "coverage" / "design.coverage.json"), "-o", str(options.out)])
    if code:
        return code
    front = sorted((row for row in rows_of(options.out / "design.csv") if int(row["on_the_front"])),
                   key=lambda row: float(row["cost [k€]"]))
    lines = []
    for row in front:
        share = f"{100 * float(row['detected [1]']):.1f} ± {100 * float(row['detected_std_error [1]']):.1f} %"
        cells = [form % (factor * float(row[name])) for name, _, factor, form in NUMBERS] + [share]
        lines.append([f"**{cell}**" if int(row["chosen"]) else cell for cell in cells])
    tools.leave(options.out, "design-front", [*(heading for _, heading, _, _ in NUMBERS), "detected"], lines, 0)
    changes = []
    for row in rows_of(options.out / "sensitivities.csv"):
        share, cost = "no such sensor", "–"
        if not row["refused"]:
            change, error = (100 * float(row[name]) for name in ("change_of_detected [1]", "change_std_error [1]"))
            share, cost = f"{change:+.1f} ± {error:.1f}", f"{float(row['change_of_cost [k€]']):+.1f}"
        changes.append((row["field"], f"{float(row['from']):.4g}", f"{float(row['to']):.4g}", share, cost))
    tools.leave(options.out, "design-sensitivities",
                ("number (SI units)", "from", "to", "share, percentage points", "cost, k€"), changes)
    with Browser(width=1100) as browser:
        browser.open(options.out / "design.html")
        browser.picture_between("h1", "#front", options.out / "head.png")
    return 0

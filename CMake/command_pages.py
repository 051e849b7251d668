# SPDX-License-Identifier: BSD-3-Clause
"""Makes the manual page and the shell completions of the command `avianlidar` from the command's parser:

    command_pages.py FOLDER     FOLDER/man/man1, FOLDER/bash-completion/completions, FOLDER/zsh/vendor-completions
"""
import argparse
import pathlib
import re
import sys

import shtab
from build_manpages.manpage import Manpage

import avianlidar
from avianlidar import vtkAvianLidar as wrapped
from avianlidar._command import VERBS, parser
from avianlidar._properties import get_property, property_names
from avianlidar.apps.inputs._json import load_json

def settings(wrapped):
    """Names of the properties that a text can set."""
    return [name for name, there in property_names(wrapped).items() if isinstance(get_property(wrapped(), there), (int, float, str, tuple))]


PLAN = load_json(pathlib.Path(avianlidar.__file__).parent / "apps" / "inputs" / "coverage.schema.json")["properties"]
NAMES = {"sensor": avianlidar.Sensor.presets(), "material": tuple(avianlidar.materials()),  # names, and starts of settings
         **{f"{part}_set": tuple(f"{name}=" for name in names) for part, names in (
             ("sensor", settings(wrapped.vtkAvianLidarBeamSource)), ("scan", settings(wrapped.vtkAvianLidarEchoFilter)),
             ("coverage", settings(wrapped.vtkAvianLidarCoverage)), ("siting", PLAN["siting"]["properties"]), ("design", PLAN["design"]["properties"]))}}


def files(whole):
    """Marks the arguments that are names of files."""
    for action in whole._actions:
        if isinstance(action, argparse._SubParsersAction):
            for verb in action.choices.values():
                files(verb)
        elif action.type is pathlib.Path or action.dest in ("scene", "scenario", "plan"):
            action.complete = shtab.FILE
        elif action.dest in NAMES or whole.prog.endswith(" sensors") and action.dest == "name":
            kind = action.dest if action.dest in NAMES else "sensor"
            action.complete = {"bash": f"_avianlidar_{kind}", "zsh": f"({' '.join(NAMES[kind])})"}
    return whole


def bash(whole):
    """The completions for bash: also names, files as an alternative to names, and settings without a blank after =. The
    replacements are necessary because the function of shtab 1.5.5 offers only the first of several choices."""
    newline = "\n"
    names = "".join(f"_avianlidar_{kind}() {{ compgen -W '{newline.join(words)}' -- $1; {'' if kind.endswith('_set') else 'compgen -f -- $1; '}}}\n"
                    for kind, words in NAMES.items())
    return shtab.complete(whole, "bash", preamble={"bash": names}).replace('"${current_action}_choices"', '"${current_action}_choices[@]"').replace(
        '="${!current_action_choices_var}"', """=$(printf '%s\\n' "${!current_action_choices_var}")""").replace(
        "\n  return 0\n}\n\ncomplete ", '\n  [[ "${COMPREPLY[0]}" != *= ]] || compopt -o nospace +o filenames\n  return 0\n}\n\ncomplete ')


def main(folder):
    whole = parser()
    whole.epilog = None
    whole.man_short_description = "simulate what a bird-watching lidar receives"
    whole._manpage = [{"heading": "examples", "content": "".join(examples for _, _, examples in VERBS.values())},
                      {"heading": "exit status", "content": "0: done; 2: an error, said in one line; 130: stopped by Ctrl-C"}]
    page = re.sub(r"^\.TH .*", f'.TH AVIANLIDAR 1 "" "avian-lidar {avianlidar.__version__}"', str(Manpage(whole)), count=1, flags=re.M)
    page = page.replace(".SH EXAMPLES\n", ".SH EXAMPLES\n.nf\n").replace(".SH EXIT STATUS\n", ".fi\n.SH EXIT STATUS\n")
    page = re.sub(r"^(usage: .*?\n)\n", r".nf\n\1.fi\n\n", page, flags=re.M | re.S)
    page = re.sub(r"^\.(?!br$|nf$|fi$|TP$|SH$|SH |SS$|TH |B )", r"\&.", page, flags=re.M)  # lines that begin with a suffix such as .las
    for name, text in (("man/man1/avianlidar.1", page),
                       ("bash-completion/completions/avianlidar", bash(files(parser()))),
                       ("zsh/vendor-completions/_avianlidar", shtab.complete(files(parser()), "zsh"))):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))

"""Makes campaigns that hide one effect, none, or one that no catalogue knows, and opens the seals into truth.json."""

import argparse
import json
import subprocess
from pathlib import Path

CAMPAIGNS = {
    "none": (8, []),
    "single": (24, ["--blind", "--effects-at-most", "1"]),
    "outside": (8, ["--blind", "--outside"]),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--tempco", type=Path, required=True)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)

    def tempco(*command):
        return subprocess.run([arguments.tempco, *command], check=True, stdout=subprocess.PIPE, text=True).stdout

    truth = {"hidden": {}}
    for kind, (count, options) in CAMPAIGNS.items():
        for seed in range(1, count + 1):
            path = arguments.folder / f"{kind}-{seed}.csv"
            tempco("simulate", "rich", *options, "--seed", str(seed), "--output", path)
            truth["hidden"][path.stem] = []
            if options:
                revealed = json.loads(tempco("reveal", path.with_suffix(".sealed"), "--json"))
                truth["hidden"][path.stem] = [hidden["effect"] for hidden in revealed["hidden"]]
                truth["noise_ug"] = revealed["noise_floor_ug"]
    (arguments.folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()

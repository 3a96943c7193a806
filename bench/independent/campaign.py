"""A campaign: device, laboratory, rig and hidden effects drawn, brought together and written down."""

import json

from device import draw_device
from draws import balanced, log_uniform
from effects import Scene
from files import columns_of, write_campaign
from history import history_of
from listed import ALSO_ACCEPTABLE, LISTED
from noise import add_noise, draw_noise, noise_ug
from oracle import Oracle
from outside import OUTSIDE
from protocol import draw_other_lab, draw_rich_lab, draw_scarce_lab
from recording import record
from rig import draw_rig, rig_error_g
from sizes import Ruler, measure, tune

# Of what is hidden behind a static map, in units of the white noise.
SIZES = (0.1, 1000.0)


def choose_hidden(rng, campaign_class, count):
    """For each campaign, the factories of what it hides and what its protocol must offer."""
    if campaign_class == "none":
        return [([], set())] * count
    if campaign_class == "outside":
        return [([factory], set()) for factory in balanced(rng, OUTSIDE, count)]
    first = balanced(rng, sorted(LISTED), count)
    chosen = [[name] for name in first]
    if campaign_class == "pair":
        partner_rng = rng.spawn(1)[0]
        partners = [[other for other in sorted(LISTED) if told_apart(name, other)] for name in first]
        chosen = [[name, str(partner_rng.choice(others))] for name, others in zip(first, partners)]
    return [([LISTED[name][0] for name in names], {need for name in names for need in LISTED[name][1]})
            for names in chosen]


def told_apart(name, other):
    """Whether two effects make a pair whose members can be told apart."""
    return other != name and other not in ALSO_ACCEPTABLE.get(name, [])


def simulate(rng, campaign_class, lab_name, real_rig, factories, needs, folder):
    lab = {"rich": draw_rich_lab, "other": draw_other_lab, "scarce": draw_scarce_lab}[lab_name](rng, needs)
    device = draw_device(rng, "zero-crossing" in needs)
    happened, written = record(rng, lab)
    rec = happened.of_rows(written)
    scene = Scene(device, rec, history_of(happened, written))
    noise, rig = draw_noise(rng, device), draw_rig(rng, real_rig and "perfect-rig" not in needs)
    ruler = Ruler(scene, noise.white_ug)
    hidden = hide(rng, factories, ruler)
    rig_g = rig_error_g(rng, rig, rec)
    oracle = Oracle(ruler, noise, rig)
    clean = measure(scene, [effect for effect, _ in hidden], rig_g)
    noisy = add_noise(rng, clean, ruler.scale_hz_per_g, noise_ug(rng, noise, rec), noise.white_ug)
    folder.mkdir(parents=True, exist_ok=True)
    write_campaign(folder, lab, columns_of(rng, lab, rig, noise, rec, noisy), rec)
    truth = {
        "class": campaign_class, "lab": lab_name, "frequency_style": lab.frequency_style, "cross_g": lab.cross,
        "auxiliary": sorted(lab.auxiliary), "runs": len(rec.kind), "rows": len(rec.run),
        "effects": describe(hidden, ruler, oracle),
        "rig": vars(rig) | ruler.sizes(measure(scene, [], rig_g)), "noise": vars(noise), "device": vars(device),
    }
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")
    return truth


def hide(rng, factories, ruler):
    hidden = []
    for factory in factories:
        effect, target = factory(rng, ruler.scene), log_uniform(rng, *SIZES)
        sign = 1.0 if effect.positive else float(rng.choice([-1.0, 1.0]))
        hidden.append((tune(effect, ruler, target, sign), target))
    return hidden


def describe(hidden, ruler, oracle):
    """Each effect with its size and with what a diagnosis could know of it at most, given the others."""
    alone = [measure(ruler.scene, [effect]) for effect, _ in hidden]
    shapes_ug = [ruler.reading_ug(frequencies) for frequencies in alone]
    return [
        {
            "name": effect.name, "description": effect.description, "amplitude": effect.amplitude, "unit": effect.unit,
            "parameters": effect.parameters, **ruler.sizes(alone[k]),
            "oracle_delta_bic": oracle.delta_bic(shapes_ug[k], shapes_ug[:k] + shapes_ug[k + 1:]),
            "snr_target": target_snr, "snr_tuned": "snr_map_only" if effect.per_run else "snr_static",
            "at_limit": abs(effect.amplitude) in effect.limits, "also_acceptable": ALSO_ACCEPTABLE.get(effect.name, []),
        }
        for k, (effect, target_snr) in enumerate(hidden)
    ]

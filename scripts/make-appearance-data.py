#!/usr/bin/env python3
"""Writes the tables of `src/appearance/`: colour maps and elements.

    pip install matplotlib==3.11.2 cmcrameri==1.10 cmocean==4.0.3 mendeleev==1.3.0
    python3 scripts/make-appearance-data.py

Colour maps: 256 rows of three sRGB bytes each, one map behind the other, in the order of `MAPS`.
matplotlib's maps are CC0 (viridis, plasma, inferno, magma, by Smith and van der Walt; cividis, by
Nunez et al. 2018), Apache 2.0 (turbo, by Mikhailov 2019) or of matplotlib's own licence (coolwarm,
by Moreland 2009; twilight, CC0, by Bechtold); cmcrameri's (Crameri 2018) and cmocean's (Thyng et
al. 2016) are MIT.

Elements: covalent radii of Cordero et al. 2008, beyond curium of Pyykko and Atsumi 2009; van der
Waals radii of the CRC Handbook of Chemistry and Physics (95th edition), that is of Bondi 1964 and
of Mantina et al. 2009, completed; colours of Jmol; standard atomic weights.
"""

import pathlib

import cmcrameri.cm
import cmocean.cm
import matplotlib
import numpy as np
from mendeleev.fetch import fetch_table

DATA = pathlib.Path(__file__).parent.parent / "src" / "appearance" / "data"
MATPLOTLIB = "viridis plasma inferno magma cividis turbo coolwarm twilight gray".split()
CRAMERI = "batlow vik roma hawaii lajolla oslo romaO".split()
CMOCEAN = "thermal haline deep balance".split()


def bytes_of(cmap):
    colors = cmap(np.linspace(0.0, 1.0, 256))[:, :3]
    return np.round(colors * 255.0).astype(np.uint8).tobytes()


def write_maps():
    maps = [matplotlib.colormaps[name] for name in MATPLOTLIB]
    maps += [getattr(cmcrameri.cm, name) for name in CRAMERI]
    maps += [getattr(cmocean.cm, name) for name in CMOCEAN]
    (DATA / "colormaps.bin").write_bytes(b"".join(map(bytes_of, maps)))


def write_elements():
    table = fetch_table("elements")
    rows = ["# symbol, mass in u, covalent and van der Waals radius in angstrom, Jmol colour"]
    for element in table.itertuples():
        covalent = element.covalent_radius_cordero
        if np.isnan(covalent):
            covalent = element.covalent_radius_pyykko
        vdw = element.vdw_radius
        color = element.jmol_color if isinstance(element.jmol_color, str) else "#eb0026"
        radii = [covalent / 100, -1 if np.isnan(vdw) else vdw / 100]
        shown = ["-" if r < 0 else f"{r:.2f}" for r in radii]
        rows.append(f"{element.symbol} {element.atomic_weight:.6g} {' '.join(shown)} {color[1:]}")
    (DATA / "elements.txt").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    write_maps()
    write_elements()

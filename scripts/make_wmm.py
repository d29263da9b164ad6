#!/usr/bin/python3
"""Coefficients of the World Magnetic Model in the files that GeographicLib's MagneticModel reads.

    make_wmm.py COEFFICIENTS.json NAME DIR      writes DIR/NAME.wmm and DIR/NAME.wmm.cof

COEFFICIENTS.json holds Gauss coefficients (Schmidt, nT and nT/year) by degree, then order: main_field_coeff_g/_h,
secular_var_coeff_g/_h, n_max, epoch, as in data/wmm-2025.json of the npm package geomagnetism. The numbers are those of NOAA NCEI and the
British Geological Survey and in the public domain.
"""
import json
import struct
import sys
from pathlib import Path

META = """WMMF-1
# World Magnetic Model {epoch}: NOAA National Centers for Environmental Information and British Geological Survey; public domain.
# Written by scripts/make_wmm.py
Name            {name}
Description     World Magnetic Model {epoch}
URL             https://www.ncei.noaa.gov/products/world-magnetic-model
Publisher       National Oceanic and Atmospheric Administration
ReleaseDate     {released}
DataVersion     1
Radius          6371200
NumModels       1
Epoch           {epoch}
DeltaEpoch      5
MinTime         {epoch}
MaxTime         {last}
MinHeight       -1000
MaxHeight       850000
Normalization   schmidt
ByteOrder       little
ID              {identity}
"""


def block(n_max, g, h):
    """Degree and order, then the cosine and sine coefficients column by column of equal order."""
    def columns(values, first):
        return [values[n * (n + 1) // 2 + m] for m in range(first, n_max + 1) for n in range(m, n_max + 1)]
    numbers = columns(g, 0) + columns(h, 1)
    return struct.pack("<ii", n_max, n_max) + struct.pack(f"<{len(numbers)}d", *numbers)


def main(source, name, folder):
    model = json.loads(Path(source).read_text(encoding="utf-8"))
    epoch, n_max = int(model["epoch"]), model["n_max"]
    identity = f"WMM{epoch}A"
    meta = META.format(name=name, epoch=epoch, last=epoch + 5, released=model["start_date"][:10], identity=identity)
    (Path(folder) / f"{name}.wmm").write_text(meta, encoding="utf-8")
    data = identity.encode("ascii")
    data += block(n_max, model["main_field_coeff_g"], model["main_field_coeff_h"])
    data += block(n_max, model["secular_var_coeff_g"], model["secular_var_coeff_h"])
    (Path(folder) / f"{name}.wmm.cof").write_bytes(data)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])

"""One small grid in many encodings, written by GDAL, NumPy and Pillow: the reader's tests expect equal heights of all.

    pip install rasterio pillow && python tests/data/dem/make.py

The files are kept in the repository, so neither is needed to build or to test.
"""

import gzip
import struct
import zipfile
from pathlib import Path

import numpy as np
import rasterio
from PIL import Image
from rasterio.crs import CRS
from rasterio.transform import Affine

HERE = Path(__file__).parent
WIDTH, HEIGHT, STEP = 37, 23, 1 / 1200
WEST, NORTH = 8.0, 47.0  # corner of the north-west sample's area
LOW, HIGH = -12, 4173

# Heights of a valley and a ridge, as whole metres, with a hole of four samples; lowest and highest are there.
row, column = np.mgrid[0:HEIGHT, 0:WIDTH]
grid = np.rint(1500 + 900 * np.sin(column / 6.0) * np.cos(row / 5.0) + 40 * ((7 * column + 11 * row) % 13)).astype(np.int64)
grid[3, 4], grid[20, 30] = LOW, HIGH
hole = np.zeros(grid.shape, bool)
hole[10:12, 17:19] = True


def filled(missing, kind):
    data = grid.astype(kind)
    data[hole] = missing
    return data


def tiff(name, missing, kind, crs="EPSG:4326", step=STEP, corner=(WEST, NORTH), **options):
    transform = Affine(step, 0, corner[0], 0, -step, corner[1])
    profile = dict(driver="GTiff", width=WIDTH, height=HEIGHT, count=1, dtype=kind, nodata=missing, transform=transform)
    if crs:
        profile["crs"] = CRS.from_user_input(crs)
    with rasterio.open(HERE / name, "w", **profile, **options) as file:
        file.write(filled(missing, kind), 1)
    for sidecar in HERE.glob("*.aux.xml"):
        sidecar.unlink()


tiff("i16.tif", -32767, "int16")
tiff("i16_big_endian.tif", -32767, "int16", ENDIANNESS="BIG")
tiff("i16_bigtiff_deflate.tif", -32767, "int16", BIGTIFF="YES", compress="deflate")
tiff("i16_lzw_p2.tif", -32767, "int16", compress="lzw", predictor=2, blockysize=5)
tiff("i16_packbits.tif", -32767, "int16", compress="packbits")
tiff("i16_zstd_p2.tif", -32767, "int16", compress="zstd", predictor=2)
tiff("i16_tiles_deflate_p2.tif", -32767, "int16", tiled=True, blockxsize=16, blockysize=16, compress="deflate", predictor=2)
tiff("i16_tiles_big_endian_zstd.tif", -32767, "int16", tiled=True, blockxsize=16, blockysize=16, compress="zstd", ENDIANNESS="BIG")
tiff("u16_deflate.tif", 65535, "uint16", compress="deflate")
tiff("i32_lzw_p2.tif", -99999, "int32", compress="lzw", predictor=2)
tiff("u32.tif", 4294967295, "uint32")
tiff("f32_deflate_p3.tif", -9999, "float32", compress="deflate", predictor=3)
tiff("f32_tiles_lzw_p3_nan.tif", float("nan"), "float32", tiled=True, blockxsize=16, blockysize=32, compress="lzw", predictor=3)
tiff("f32_zstd_p3_big_endian.tif", -3.4028234663852886e38, "float32", compress="zstd", predictor=3, ENDIANNESS="BIG")
tiff("f64_deflate_p3.tif", -9999, "float64", compress="deflate", predictor=3)
# Other ways to say where it lies: metres, feet.
tiff("utm.tif", -32767, "int16", crs="EPSG:32632", step=90.0, corner=(500000.0, 5200000.0))
tiff("feet.tif", -32767, "int16", crs="EPSG:2263", step=100.0, corner=(980000.0, 200000.0))
# Small numbers fit in a byte: the heights divided by 40.
for kind, missing in [("int8", -128), ("uint8", 255)]:
    small = (grid // 40).clip(0, 105)
    small[hole] = missing
    with rasterio.open(HERE / f"{'i' if kind == 'int8' else 'u'}8.tif", "w", driver="GTiff", width=WIDTH, height=HEIGHT, count=1, dtype=kind,
                       nodata=missing, crs="EPSG:4326", transform=Affine(STEP, 0, WEST, 0, -STEP, NORTH), compress="lzw") as file:
        file.write(small.astype(kind), 1)

with open(HERE / "grid.asc", "w") as file:
    file.write(f"ncols {WIDTH}\nnrows {HEIGHT}\nxllcorner {WEST}\nyllcorner {NORTH - HEIGHT * STEP:.12f}\ncellsize {STEP:.12f}\nNODATA_value -9999\n")
    for line in filled(-9999, np.int64):
        file.write(" ".join(map(str, line)) + "\n")

filled(-32767, "<i2").tofile(HERE / "grid.bil")
(HERE / "grid.hdr").write_text(
    f"BYTEORDER I\nLAYOUT BIL\nNROWS {HEIGHT}\nNCOLS {WIDTH}\nNBANDS 1\nNBITS 16\nPIXELTYPE SIGNEDINT\n"
    f"ULXMAP {WEST + STEP / 2:.12f}\nULYMAP {NORTH - STEP / 2:.12f}\nXDIM {STEP:.12f}\nYDIM {STEP:.12f}\nNODATA -32767\n")
np.save(HERE / "f32.npy", filled(np.nan, "float32"))

# Images: 0 stands for a missing sample.
(HERE / "grid.pgm").write_bytes(f"P5 {WIDTH} {HEIGHT} 65535\n".encode() + filled(0, np.int64).clip(0).astype(">u2").tobytes())
grey = np.rint(1 + (grid - LOW) / (HIGH - LOW) * 65534)
grey[hole] = 0
Image.fromarray(grey.astype(np.uint16)).save(HERE / "grey.png")
for name, packed in [("terrarium", (filled(0, np.int64) + 32768) * 256), ("terrain_rgb", (filled(0, np.int64) + 10000) * 10)]:
    rgb = np.stack([packed >> 16, packed >> 8 & 255, packed & 255], -1).astype(np.uint8)
    Image.fromarray(rgb).save(HERE / f"{name}.png")

# A square of the grid as SRTM has it.
square = filled(-32768, ">i2")[:23, :23].tobytes()
(HERE / "N46E008.hgt.gz").write_bytes(gzip.compress(square, mtime=0))
with zipfile.ZipFile(HERE / "N46E008.zip", "w", zipfile.ZIP_DEFLATED) as archive:
    archive.writestr(zipfile.ZipInfo("N46E008.hgt", (2020, 1, 1, 0, 0, 0)), square, zipfile.ZIP_DEFLATED)

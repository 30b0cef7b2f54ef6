"""A scan or a part -> its first four levels, side by side, in one picture:  levels.py INPUT PICTURE [iso]"""
import sys

import isowave
import matplotlib.pyplot as plt

options = {"iso": float(sys.argv[3])} if len(sys.argv) > 3 else {"voxels": 96}
ladder = isowave.lod(sys.argv[1], levels=(0, 3), **options)
figure, panels = plt.subplots(1, len(ladder), figsize=(4 * len(ladder), 4), subplot_kw={"projection": "3d"})
for level, panel in zip(ladder, panels):
    x, y, z = level.points.T
    panel.plot_trisurf(x, y, z, triangles=level.triangles, color="#d8cfbd", lw=0, antialiased=False)
    panel.set_box_aspect([v.max() - v.min() for v in (x, y, z)], zoom=1.2)
    panel.set(title=f"level {level.level}: {len(level.triangles):,} triangles, genus {level.report['genus']}")
    panel.set_axis_off()
figure.savefig(sys.argv[2], dpi=100, bbox_inches="tight")

#!/usr/bin/python3
"""africa.py land-50m.json > africa.geojson: Africa out of world-atlas's TopoJSON of the world's land."""
import json
import sys


def polygons(path):
    world = json.load(open(path))
    scale, shift = world['transform']['scale'], world['transform']['translate']
    arcs = []
    for arc in world['arcs']:
        x = y = 0
        points = []
        for dx, dy in arc:
            x, y = x + dx, y + dy
            points.append((round(x * scale[0] + shift[0], 4), round(y * scale[1] + shift[1], 4)))
        arcs.append(points)
    for geometry in world['objects']['land']['geometries']:
        for polygon in geometry['arcs']:
            rings = []
            for numbers in polygon:
                ring = []
                for i in numbers:
                    arc = arcs[i] if i >= 0 else arcs[~i][::-1]
                    ring += arc[1:] if ring else arc
                rings.append(ring)
            yield rings


def mainland(ring):
    """The part of the ring of three continents that lies west of the Suez canal, closed along the canal."""
    ring = ring[:-1] if ring[0] == ring[-1] else ring

    def nearest(x, y):
        return min(range(len(ring)), key=lambda i: (ring[i][0] - x) ** 2 + (ring[i][1] - y) ** 2)

    a, b = sorted((nearest(32.3, 31.25), nearest(32.55, 29.95)))  # Port Said, Suez
    for part in (ring[a:b + 1], ring[b:] + ring[:a + 1]):
        if min(y for _, y in part) < -30 and max(x for x, _ in part) < 60:
            return part + part[:1]


def is_african(ring):
    x = sum(p[0] for p in ring) / len(ring)
    y = sum(p[1] for p in ring) / len(ring)
    return (all(-26 < p[0] < 58 and -36 < p[1] < 38 for p in ring) and -19 < x < 51.5 and y < 33
            and not (x > 33 and y > 12.3))


land = list(polygons(sys.argv[1]))
rings = [[mainland(max(land, key=lambda p: len(p[0]))[0])]] + [p for p in land if is_african(p[0])]
json.dump({'type': 'Feature', 'properties': {'name': 'Africa'},
           'geometry': {'type': 'MultiPolygon', 'coordinates': rings}}, sys.stdout, separators=(',', ':'))

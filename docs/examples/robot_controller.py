#!/usr/bin/env python3
"""A controller of vernier drive as a program: drives on, and turns away from what stands near in front."""
import json
import math
import sys

NEAR_M, STEPS = 1.2, 60


def depth_ahead(edges, focal_px, baseline_m, width_px):
    """Depth of the nearest edge in the middle third of the image, from the disparity of its middle."""
    nearest = math.inf
    for edge in edges:
        left, right = edge['left_px'], edge['right_px']
        middle = (left[0] + left[2]) / 2
        disparity = middle - (right[0] + right[2]) / 2
        if width_px / 3 < middle < 2 * width_px / 3 and disparity > 0:
            nearest = min(nearest, focal_px * baseline_m / disparity)
    return nearest


hello = json.loads(sys.stdin.readline())
left, right = hello['cameras']
focal_px, width_px = left['parameters']['f_px'], left['size_px'][0]
baseline_m = math.hypot(*right['from_first']['translation_m'])
print(json.dumps({'ready': True}), flush=True)
side = 1
for line in sys.stdin:
    seen = json.loads(line)
    if seen['frame'] == STEPS:
        answer = {'done': True}
    elif seen['contact']:
        side = -side
        answer = {'speed_mps': -0.2, 'turn_radps': 0, 'duration_s': 1}
    elif depth_ahead(seen['edges'], focal_px, baseline_m, width_px) < NEAR_M:
        answer = {'speed_mps': 0, 'turn_radps': 0.8 * side, 'duration_s': 0.5}
    else:
        answer = {'speed_mps': 0.4, 'turn_radps': 0, 'duration_s': 0.5}
    print(json.dumps({'question': seen['question'], **answer}), flush=True)

#!/usr/bin/python3
"""One peer, one process, one line of JSON: seconds and peak memory for a dense boolean volume.

  peers.py NAME VOLUME.raw NX NY NZ      NAME: watershed, edt; the volume is uint8, x fastest

watershed: scipy's exact distance transform, its maxima at least 8 voxels apart as markers,
scikit-image's watershed on its negative inside the object: what is commonly done. edt: the distance
transform alone. Exits with 3 if a library is missing.
"""
import json
import resource
import sys
import time

import numpy

name, path = sys.argv[1:3]
shape = tuple(int(n) for n in sys.argv[5:2:-1])
solid = numpy.fromfile(path, numpy.uint8).reshape(shape) > 0
result = {"voxels": int(solid.sum()), "domain_voxels": solid.size}
try:
    from scipy import ndimage
    if name == "watershed":
        from skimage.feature import peak_local_max
        from skimage.segmentation import watershed
    start = time.perf_counter()
    distance = ndimage.distance_transform_edt(solid)
    if name == "watershed":
        peaks = peak_local_max(distance, min_distance=8, labels=solid.astype(numpy.int32))
        markers = numpy.zeros(solid.shape, numpy.int32)
        markers[tuple(peaks.T)] = numpy.arange(1, len(peaks) + 1)
        labels = watershed(-distance, markers, mask=solid)
        result["grains"] = int(labels.max())
except ImportError as missing:
    print(f"{name}: {missing}", file=sys.stderr)
    sys.exit(3)
result["seconds"] = time.perf_counter() - start
result["peak_memory_bytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(json.dumps(result))

# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # From a gray scan to a figure
#
# A scan of sintered grains, made up so that this runs anywhere: gray values, noise, a round field
# of view. With your own, `scan` is a file or an array, and the first cell goes.

# %%
import matplotlib.pyplot as plt
import numpy as np

import vdb_madf as madf

solid, truth = madf.generate("bed", size=(96, 110, 110), radius=(9, 15), rounds=4, seed=4)
z, y, x = np.indices(solid.shape)
outside = (y - 54.5) ** 2 + (x - 54.5) ** 2 > 54**2
noise = np.random.default_rng(1).normal(0, 14, solid.shape)
scan = np.where(outside, 0, (70 + 100 * np.asarray(solid) + noise).clip(1, 255)).astype(np.uint8)

# %% [markdown]
# ## What is solid?
#
# A Gaussian takes the noise away, Otsu's threshold is found within the field of view, and specks
# go. Only voxels in the cylinder are known: nothing outside of it is taken for air.

# %%
mask = madf.Mask(scan, threshold="otsu", smooth=1.0, despeckle=30, voxel_size="8.5um",
                 roi=madf.Cylinder("z", center=(54.5, 54.5), radius=53))
print(mask.metadata["madf_object"])
print(f"solid fraction {mask.fraction:.3f}; to segment it takes up to "
      f"{mask.segment_memory / 2**20:.0f} MiB")

# %% [markdown]
# ## Grains
#
# How sure is their number? If it hardly changes with strictness, the grains are clear.

# %%
seg = madf.segment(mask)
sweep = seg.sweep(np.linspace(8, 14, 13))
print(seg.counts["grains"], "grains;",
      dict(zip(sweep["strictness"].tolist(), sweep["grains"].tolist())))
agreement = madf.compare(truth, seg.labels)
print(f"{agreement.misclassified_percent:.1f} % of the voxels lie in a wrong grain")

# %% [markdown]
# ## Numbers
#
# Grains that the wall cuts are left out of their sizes; of bonds all count.

# %%
measured = madf.measure(seg.labels)
grains, bonds = measured.grains, measured.bonds
whole = ~grains["at_domain_face"]
print(f"{whole.sum()} of {len(whole)} grains are whole,",
      f"{measured.sample['mean_coordination']:.1f} bonds a grain,",
      f"specific surface {measured.sample['specific_surface']:.1f} "
      f"{measured.units['specific_surface']}")

# %% [markdown]
# ## The figure

# %%
middle = mask.shape[0] // 2
ids, rgb = seg.labels.colors()
palette = np.full((ids.max() + 1, 3), 255, np.uint8)
palette[ids] = rgb
coordination = seg.labels.paint(grains["id"], grains["coordination"])

figure, axes = plt.subplots(1, 4, figsize=(12, 3), layout="tight")
axes[0].imshow(scan[middle], cmap="gray")
axes[0].set_title("the scan")
axes[1].imshow(palette[seg.labels[middle]])
axes[1].set_title(f"{len(ids)} grains")
shown = axes[2].imshow(coordination[middle], cmap="viridis")
axes[2].set_title("bonds of the grain")
figure.colorbar(shown, ax=axes[2])
axes[3].hist(grains["equivalent_diameter"][whole], weights=grains["volume"][whole], bins=8)
axes[3].set(title="sizes of whole grains", xlabel=f"diameter ({measured.unit})",
            ylabel=f"volume ({measured.units['volume']})")
for picture in axes[:3]:
    picture.set_axis_off()
figure.savefig("tutorial.png", dpi=90)

# %% [markdown]
# ## What stays
#
# The labels with their provenance, and a mesh for Blender or ParaView.

# %%
seg.save("tutorial.vdb")
seg.labels.save("tutorial.ply")

// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
//
// ImageJ and Fiji: cuts the stack in front into grains, and brings back their labels and tables.
// Plugins > Macros > Run, or in a script
//
//   runMacro("imagej_vdb_madf.ijm", "segment=[--threshold otsu] measure=[--shape]");
//
// `command` is the program, if it is not in the PATH. `segment` and `measure` are options of these
// verbs, without spaces within. Voxel size and unit are those of the image. What is there afterwards: the
// image "grains of ...", whose values are the labels, and the tables "grains.csv" and "bonds.csv".

arguments = getArgument();
if (arguments == "") {
  Dialog.create("Grains of the stack");
  Dialog.addString("Program", "vdb_madf", 40);
  Dialog.addString("Options of segment", "--threshold otsu", 40);
  Dialog.addString("Options of measure", "", 40);
  Dialog.show();
  program = Dialog.getString();
  segmentOptions = Dialog.getString();
  measureOptions = Dialog.getString();
} else {
  program = valueOf(arguments, "command", "vdb_madf");
  segmentOptions = valueOf(arguments, "segment", "");
  measureOptions = valueOf(arguments, "measure", "");
}

if (nImages == 0) exit("open a stack first");
title = getTitle();
getVoxelSize(width, height, depth, unit);
size = "";
if (unit != "pixel" && unit != "pixels" && unit != "") {
  if (unit == "micron" || unit == "microns" || unit == fromCharCode(181) + "m") unit = "um";
  size = " --voxel-size " + d2s(width, 9) + "x" + d2s(height, 9) + "x" + d2s(depth, 9) + unit;
}

folder = getDirectory("temp") + "vdb_madf_" + d2s(getTime(), 0) + File.separator;
File.makeDirectory(folder);
saveAs("Tiff", folder + "scan.tif");
rename(title);  // what saveAs made of it
run_madf(program, "segment " + folder + "scan.tif " + folder + "grains.vdb -q " + segmentOptions + size);
run_madf(program, "convert " + folder + "grains.vdb " + folder + "grains.tif -q");
run_madf(program, "measure " + folder + "grains.vdb " + folder + "tables -q " + measureOptions);
Table.open(folder + "tables" + File.separator + "grains.csv");
Table.open(folder + "tables" + File.separator + "bonds.csv");
open(folder + "grains.tif");
rename("grains of " + title);
setVoxelSize(width, height, depth, unit);
run("3-3-2 RGB");
resetMinAndMax();
remove(folder);

// Runs the program; stops with what it says if it fails.
function run_madf(program, words) {
  said = exec("sh", "-c", "'" + program + "' " + words + " 2>&1 && echo done");
  if (!endsWith(said, "done\n")) exit(said);
}

// What stands behind `key=` in the arguments, in brackets if it has spaces.
function valueOf(arguments, key, otherwise) {
  at = indexOf(" " + arguments, " " + key + "=");
  if (at < 0) return otherwise;
  rest = substring(arguments, at + lengthOf(key) + 1);
  if (startsWith(rest, "[")) return substring(rest, 1, indexOf(rest, "]"));
  end = indexOf(rest, " ");
  if (end < 0) return rest;
  return substring(rest, 0, end);
}

function remove(folder) {
  names = getFileList(folder);
  for (i = 0; i < names.length; i++) {
    if (endsWith(names[i], "/")) remove(folder + names[i]);
    else File.delete(folder + names[i]);
  }
  File.delete(folder);
}

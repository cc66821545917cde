// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
//
// ImageJ and Fiji: cuts the stack in front into grains, and brings back their labels and tables.
// tools/manual/imagej.md says how to install it. In a macro:
//
//   run("Vdb Madf", "segment=[--threshold otsu] measure=[--shape]");

import ij.IJ;
import ij.ImagePlus;
import ij.ImageStack;
import ij.Prefs;
import ij.WindowManager;
import ij.gui.GenericDialog;
import ij.io.FileSaver;
import ij.io.Opener;
import ij.measure.Calibration;
import ij.measure.ResultsTable;
import ij.plugin.PlugIn;
import ij.process.ImageProcessor;
import ij.process.LUT;
import java.awt.Color;
import java.io.File;
import java.io.IOException;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.concurrent.TimeUnit;
import java.util.regex.Matcher;
import java.util.regex.Pattern;

public class Vdb_Madf implements PlugIn {
  private static final String PLACE = "vdb_madf.command";  // of the command, in ImageJ's preferences

  @Override
  public void run(String unused) {
    ImagePlus scan = WindowManager.getCurrentImage();
    if (scan == null) {
      IJ.noImage();
      return;
    }
    // The first words of the labels are the keys in macros.
    GenericDialog dialog = new GenericDialog("Grains of the stack");
    dialog.addStringField("Command", Prefs.get(PLACE, "vdb_madf"), 40);
    dialog.addStringField("Segment with options", "--threshold otsu", 40);
    dialog.addStringField("Measure with options", "", 40);
    dialog.showDialog();
    if (dialog.wasCanceled()) return;
    String command = dialog.getNextString();
    List<String> segment = words(dialog.getNextString());
    List<String> measure = words(dialog.getNextString());
    Prefs.set(PLACE, command);

    File folder = null;
    try {
      folder = Files.createTempDirectory("vdb_madf_").toFile();
      cut(scan, command, segment, measure, folder);
    } catch (IOException error) {
      IJ.error(error.getMessage());
    } finally {
      IJ.showStatus("");
      remove(folder);
    }
  }

  private static void cut(ImagePlus scan, String command, List<String> segment,
                          List<String> measure, File folder) throws IOException {
    Calibration calibration = scan.getCalibration().copy();
    ImageStack stack = scan.getImageStack();
    if (calibration.calibrated()) stack = shown(stack, calibration.getCTable());
    calibration.disableDensityCalibration();
    // An image of its own, for saving changes what an image says of its file.
    ImagePlus copy = new ImagePlus(scan.getTitle(), stack);
    copy.setDimensions(scan.getNChannels(), scan.getNSlices(), scan.getNFrames());
    copy.setCalibration(calibration);
    String file = folder + "/scan.tif";
    if (!(copy.getStackSize() > 1 ? new FileSaver(copy).saveAsTiffStack(file)
                                  : new FileSaver(copy).saveAsTiff(file)))
      throw new IOException("the stack could not be written into " + folder);
    boolean overruled = false;
    for (String word : segment) overruled |= word.matches("--voxel-size(=.*)?");
    if (!overruled) segment.addAll(size(calibration));

    run(folder, command, segment, "segment", "/scan.tif", "/grains.vdb");
    run(folder, command, Arrays.asList("-q"), "convert", "/grains.vdb", "/grains.tif");
    run(folder, command, measure, "measure", "/grains.vdb", "/tables");
    String info = run(folder, command, new ArrayList<String>(), "info", "/grains.vdb");

    ImagePlus grains = new Opener().openImage(folder + "/grains.tif");
    if (grains == null) throw new IOException("the labels could not be opened");
    grains.setTitle("grains of " + scan.getTitle());
    Calibration own = overruled ? grains.getCalibration().copy() : calibration.copy();
    Matcher first =
        Pattern.compile("madf_domain_min = \\[(-?\\d+),(-?\\d+),(-?\\d+)\\]").matcher(info);
    if (first.find()) {  // labels of a crop lie where it does
      own.xOrigin = calibration.xOrigin - Integer.parseInt(first.group(1));
      own.yOrigin = calibration.yOrigin - Integer.parseInt(first.group(2));
      own.zOrigin = calibration.zOrigin - Integer.parseInt(first.group(3));
    }
    grains.setCalibration(own);
    grains.setLut(colors());
    grains.resetDisplayRange();
    for (String name : new String[] {"grains.csv", "bonds.csv"})
      ResultsTable.open(folder + "/tables/" + name).show(name);
    grains.show();
  }

  /** The values that ImageJ shows: it holds signed samples, for one, as unsigned ones. */
  private static ImageStack shown(ImageStack stack, float[] values) {
    ImageStack shown = new ImageStack(stack.getWidth(), stack.getHeight());
    for (int i = 1; i <= stack.getSize(); ++i) {
      ImageProcessor slice = stack.getProcessor(i);
      slice.setCalibrationTable(values);
      shown.addSlice(slice.convertToFloat());
    }
    return shown;
  }

  /** Runs a verb on files of the folder, logs its notes, returns what it prints; fails with what it
   *  says. */
  private static String run(File folder, String command, List<String> options, String verb,
                            String... files) throws IOException {
    List<String> line = new ArrayList<>(Arrays.asList(command, verb));
    for (String file : files) line.add(folder + file);
    line.addAll(options);
    IJ.showStatus("vdb_madf " + verb + " (Esc stops it)");
    File printed = new File(folder, "printed.txt");
    File said = new File(folder, "said.txt");
    IJ.resetEscape();
    Process process =
        new ProcessBuilder(line).redirectOutput(printed).redirectError(said).start();
    boolean stopped = false;
    while (process.isAlive()) {  // also when it was told to stop, for it may still write
      try {
        process.waitFor(100, TimeUnit.MILLISECONDS);
      } catch (InterruptedException error) {
        stopped = true;
      }
      stopped |= IJ.escapePressed();
      if (stopped) process.destroy();
    }
    if (stopped) throw new IOException(verb + " was stopped");
    String errors = text(said).trim();
    if (process.exitValue() != 0) throw new IOException(errors);
    for (String note : errors.split("\n"))
      if (note.startsWith("vdb_madf: note:")) IJ.log(note.replace(folder + "/", ""));
    return text(printed);
  }

  private static String text(File file) throws IOException {
    return new String(Files.readAllBytes(file.toPath()), StandardCharsets.UTF_8);
  }

  /** Splits options at blanks; those in double quotes stay together. */
  private static List<String> words(String options) {
    List<String> words = new ArrayList<>();
    Matcher word = Pattern.compile("\"([^\"]*)\"|\\S+").matcher(options);
    while (word.find()) words.add(word.group(1) != null ? word.group(1) : word.group());
    return words;
  }

  /** The voxel size if its unit is one of the command; others, as inches, are a printer's. */
  private static List<String> size(Calibration calibration) {
    String unit = calibration.getUnit().replace('\u00b5', 'u').replaceFirst("^microns?$", "um");
    if (!unit.matches("nm|um|mm|m")) return new ArrayList<String>();
    return Arrays.asList("--voxel-size", calibration.pixelWidth + "x" + calibration.pixelHeight +
                                             "x" + calibration.pixelDepth + unit);
  }

  /** Black, and 255 colors that differ from those beside them. */
  private static LUT colors() {
    byte[][] bands = new byte[3][256];
    for (int i = 1; i < 256; ++i) {
      Color color = Color.getHSBColor(0.618034f * i, 1 - 0.2f * (i % 3), 1 - 0.15f * (i % 4));
      bands[0][i] = (byte) color.getRed();
      bands[1][i] = (byte) color.getGreen();
      bands[2][i] = (byte) color.getBlue();
    }
    return new LUT(bands[0], bands[1], bands[2]);
  }

  private static void remove(File file) {
    if (file == null) return;
    File[] inside = file.listFiles();
    if (inside != null)
      for (File each : inside) remove(each);
    file.delete();
  }
}

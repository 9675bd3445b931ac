// SPDX-License-Identifier: BSD-3-Clause
#include "vtk.hpp"

#include "xml.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedIntArray.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

namespace conceg::exporting {
namespace {

template <class Array, class Values>
void add_column(vtkDataSetAttributes *to, const char *name, const Values &values) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); i++)
    array->SetValue(static_cast<vtkIdType>(i), values[i]);
  to->AddArray(array);
}

// VTK writes into memory and the bytes go through OutputFile, so that a failed write leaves nothing behind.
template <class Writer> void write_xml(const std::string &path, Writer *writer) {
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetByteOrderToLittleEndian();
  writer->SetCompressorTypeToLZ4();
  writer->WriteToOutputStringOn();
  if (!writer->Write()) fail(CONCEG_E_IO, "%s: VTK could not encode the data", path.c_str());
  OutputFile file(path);
  file.write(writer->GetOutputString());
  file.commit();
}

vtkNew<vtkPoints> double_points(std::size_t count) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(count));
  return points;
}

} // namespace

void write_skeletons_vtp(const std::string &path, const std::vector<SkeletonPiece> &pieces) {
  std::size_t total = 0;
  for (const SkeletonPiece &piece : pieces)
    total += piece.tree->size() + (piece.soma_radius > 0.0);
  vtkNew<vtkPoints> points = double_points(total);
  vtkNew<vtkCellArray> lines, somas;
  std::vector<double> radius, target;
  std::vector<std::uint8_t> kind;
  std::vector<std::uint32_t> cell, type, soma_cell, soma_type, line_cell, line_type;
  vtkIdType base = 0;
  for (const SkeletonPiece &piece : pieces) {
    const Tree &tree = *piece.tree;
    if (piece.soma_radius > 0.0) {
      points->SetPoint(base, piece.soma.x, piece.soma.y, piece.soma.z);
      somas->InsertNextCell(1, &base);
      radius.push_back(piece.soma_radius), target.push_back(piece.soma_radius), kind.push_back(1);
      cell.push_back(piece.cell), type.push_back(piece.type);
      soma_cell.push_back(piece.cell), soma_type.push_back(piece.type);
      base++;
    }
    for (std::size_t i = 0; i < tree.size(); i++) {
      points->SetPoint(base + static_cast<vtkIdType>(i), tree.position[i].x, tree.position[i].y,
                       tree.position[i].z);
      radius.push_back(tree.radius[i]);
      target.push_back(tree.target_radius.empty() ? tree.radius[i] : tree.target_radius[i]);
      kind.push_back(tree.kind[i]);
      cell.push_back(piece.cell), type.push_back(piece.type);
    }
    for (const std::vector<std::uint32_t> &run : runs(tree)) {
      if (run.size() < 2) continue;
      lines->InsertNextCell(static_cast<vtkIdType>(run.size()));
      for (const std::uint32_t point : run)
        lines->InsertCellPoint(base + static_cast<vtkIdType>(point));
      line_cell.push_back(piece.cell), line_type.push_back(piece.type);
    }
    base += static_cast<vtkIdType>(tree.size());
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetVerts(somas);
  data->SetLines(lines);
  add_column<vtkDoubleArray>(data->GetPointData(), "radius", radius);
  add_column<vtkDoubleArray>(data->GetPointData(), "target_radius", target);
  add_column<vtkUnsignedCharArray>(data->GetPointData(), "kind", kind);
  add_column<vtkUnsignedIntArray>(data->GetPointData(), "cell", cell);
  add_column<vtkUnsignedIntArray>(data->GetPointData(), "type", type);
  // VTK numbers the cells of polydata vertices first, then lines.
  soma_cell.insert(soma_cell.end(), line_cell.begin(), line_cell.end());
  soma_type.insert(soma_type.end(), line_type.begin(), line_type.end());
  add_column<vtkUnsignedIntArray>(data->GetCellData(), "cell", soma_cell);
  add_column<vtkUnsignedIntArray>(data->GetCellData(), "type", soma_type);
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  write_xml(path, writer.GetPointer());
}

void write_surface_vtp(const std::string &path, const SurfacePiece &piece) {
  const Surface &surface = *piece.surface;
  vtkNew<vtkPoints> points = double_points(surface.vertex.size());
  for (std::size_t i = 0; i < surface.vertex.size(); i++)
    points->SetPoint(static_cast<vtkIdType>(i), surface.vertex[i].x, surface.vertex[i].y,
                     surface.vertex[i].z);
  vtkNew<vtkCellArray> triangles;
  triangles->AllocateExact(static_cast<vtkIdType>(surface.face.size()),
                           3 * static_cast<vtkIdType>(surface.face.size()));
  for (const glm::uvec3 &face : surface.face) {
    const vtkIdType corner[3] = {face.x, face.y, face.z};
    triangles->InsertNextCell(3, corner);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(triangles);
  if (!piece.compartment.empty())
    add_column<vtkUnsignedCharArray>(data->GetCellData(), "compartment", piece.compartment);
  if (!piece.component.empty())
    add_column<vtkUnsignedIntArray>(data->GetCellData(), "component", piece.component);
  if (!piece.section.empty()) add_column<vtkUnsignedIntArray>(data->GetCellData(), "section", piece.section);
  add_column<vtkUnsignedIntArray>(data->GetCellData(), "cell",
                                  std::vector<std::uint32_t>(surface.face.size(), piece.cell));
  add_column<vtkUnsignedIntArray>(data->GetCellData(), "type",
                                  std::vector<std::uint32_t>(surface.face.size(), piece.type));
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  write_xml(path, writer.GetPointer());
}

void write_blocks_vtm(const std::string &path, const std::vector<Block> &blocks) {
  OutputFile file(path);
  file.write("<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
             "byte_order=\"LittleEndian\">\n"
             "  <vtkMultiBlockDataSet>\n");
  for (std::size_t i = 0; i < blocks.size(); i++)
    file.write("    <DataSet index=\"" + std::to_string(i) + "\" name=\"" + escaped_xml(blocks[i].name) +
               "\" file=\"" + escaped_xml(blocks[i].file) + "\"/>\n");
  file.write("  </vtkMultiBlockDataSet>\n</VTKFile>\n");
  file.commit();
}

void write_volume_vti(const std::string &path, const Volume &volume) {
  vtkNew<vtkImageData> image;
  image->SetOrigin(volume.origin.x, volume.origin.y, volume.origin.z);
  image->SetSpacing(volume.spacing.x, volume.spacing.y, volume.spacing.z);
  image->SetDimensions(volume.shape.x, volume.shape.y, volume.shape.z);
  if (!volume.label.empty()) add_column<vtkUnsignedIntArray>(image->GetPointData(), "label", volume.label);
  if (!volume.distance.empty()) add_column<vtkFloatArray>(image->GetPointData(), "distance", volume.distance);
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetInputData(image);
  write_xml(path, writer.GetPointer());
}

} // namespace conceg::exporting

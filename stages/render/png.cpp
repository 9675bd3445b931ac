// SPDX-License-Identifier: BSD-3-Clause
#include "png.hpp"

#include "output.hpp"

#include <glm/common.hpp>

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>

namespace conceg::rendering {

void write_png(const std::string &path, const Image &image) {
  vtkNew<vtkImageData> data;
  data->SetDimensions(image.width, image.height, 1);
  data->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto *bytes = static_cast<unsigned char *>(data->GetScalarPointer());
  for (int y = image.height - 1; y >= 0; y--) // VTK's rows go up
    for (int x = 0; x < image.width; x++)
      for (int k = 0; k < 3; k++)
        *bytes++ = static_cast<unsigned char>(glm::clamp(image.at(x, y)[k], 0.0f, 1.0f) * 255.0f + 0.5f);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(data);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray *result = writer->GetResult();
  if (!result || result->GetNumberOfTuples() == 0)
    fail(CONCEG_E_IO, "%s: VTK could not encode the picture", path.c_str());
  OutputFile file(path);
  file.write(result->GetPointer(0), static_cast<std::size_t>(result->GetNumberOfTuples()));
  file.commit();
}

} // namespace conceg::rendering

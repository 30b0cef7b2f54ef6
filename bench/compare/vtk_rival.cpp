#include "vtk_rival.h"

#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>
#include <vtkSmartPointer.h>

#include <chrono>

namespace isowave::bench {
namespace {

template <class Work>
double seconds(const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

VtkLevels vtkLevels(std::vector<float>& values, int size, const std::vector<std::int64_t>& wanted) {
    vtkNew<vtkFloatArray> array;
    array->SetArray(values.data(), static_cast<vtkIdType>(values.size()), /*save=*/1);
    vtkNew<vtkImageData> image;
    image->SetDimensions(size, size, size);
    image->GetPointData()->SetScalars(array);

    VtkLevels result;
    vtkSmartPointer<vtkPolyData> mesh;
    result.contourSeconds = seconds([&] {
        vtkNew<vtkFlyingEdges3D> contour;
        contour->SetInputData(image);
        contour->SetValue(0, 0.0);
        contour->ComputeScalarsOff();
        contour->Update();
        mesh = contour->GetOutput();
    });
    result.triangles.push_back(mesh->GetNumberOfPolys());
    result.decimateSeconds = seconds([&] {
        for (const std::int64_t count : wanted) {
            vtkNew<vtkQuadricDecimation> decimate;
            decimate->SetInputData(mesh);
            decimate->SetTargetReduction(1.0 - double(count) / double(mesh->GetNumberOfPolys()));
            decimate->Update();
            mesh = decimate->GetOutput();
            result.triangles.push_back(mesh->GetNumberOfPolys());
        }
    });
    return result;
}

}  // namespace isowave::bench

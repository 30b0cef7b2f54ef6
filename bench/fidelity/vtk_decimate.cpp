// VTK's two decimations, in a file of its own: its headers are dear, and it may not be there.
#include <vtkCellArray.h>
#include <vtkDecimatePro.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include "rivals.h"

namespace isowave::bench {
namespace {

vtkNew<vtkPolyData> polyDataOf(const TriangleMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Point& p : mesh.points) points->InsertNextPoint(p.data());
    vtkNew<vtkCellArray> cells;
    for (const Triangle& t : mesh.triangles) cells->InsertNextCell({t[0], t[1], t[2]});
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    return data;
}

TriangleMesh meshOf(vtkPolyData& data) {
    TriangleMesh mesh;
    for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
        const double* p = data.GetPoint(i);
        mesh.points.push_back({p[0], p[1], p[2]});
    }
    vtkNew<vtkIdList> corners;
    for (vtkIdType i = 0; i < data.GetNumberOfPolys(); ++i) {
        data.GetPolys()->GetCellAtId(i, corners);
        Triangle t;
        for (int k = 0; k < 3; ++k) t[k] = static_cast<std::uint32_t>(corners->GetId(k));
        mesh.triangles.push_back(t);
    }
    return mesh;
}

double reduction(const TriangleMesh& mesh, std::int64_t triangles) {
    return 1 - static_cast<double>(triangles) / static_cast<double>(mesh.triangles.size());
}

}  // namespace

TriangleMesh vtkQuadric(const TriangleMesh& mesh, std::int64_t triangles) {
    vtkNew<vtkQuadricDecimation> filter;
    filter->SetInputData(polyDataOf(mesh));
    filter->SetTargetReduction(reduction(mesh, triangles));
    filter->Update();
    return meshOf(*filter->GetOutput());
}

TriangleMesh vtkPro(const TriangleMesh& mesh, std::int64_t triangles) {
    vtkNew<vtkDecimatePro> filter;
    filter->SetInputData(polyDataOf(mesh));
    filter->SetTargetReduction(reduction(mesh, triangles));
    filter->PreserveTopologyOn();
    filter->Update();
    return meshOf(*filter->GetOutput());
}

}  // namespace isowave::bench

// Catmull-Clark backwards with the widest A: the least-squares fit of eleven by eleven fine points, at any valence.
//
// The rows of catmull_clark.h are short, and O(11) makes them a little better; what they leave grows from level to
// level. Here A is the shortest row with AP = I on the fine points of all vertices within two faces of v, their edges
// and faces (least_norm_rows.h), which where four meet is A11 x A11 of the cubic B-spline; along sharp edges the curve's
// own A11. With the details D of the trial inverse A0,  A f = A0 f + A D,  so A D is the shift and nothing else changes:
// what is stored, and how it is put together, are the trial variant's.
// Where the window has no row (valence 3 all around: nothing there but the mean of neighbours says where v was) the
// trial row stays.
#pragma once

#include <memory>
#include <vector>

#include "subdivision/meshes/catmull_clark.h"
#include "subdivision/meshes/least_norm_rows.h"

namespace isowave::subdivision {

class WideCatmullClarkStep final : public SubdivisionStep {
  public:
    // REQUIRES: defects(coarse).empty().
    explicit WideCatmullClarkStep(const PolygonMesh& coarse);

    PolygonMesh fineMesh() const override { return trial_->fineMesh(); }
    std::vector<Vec3> subdivide(std::span<const Vec3> coarse) const override {
        return trial_->subdivide(coarse);
    }
    std::vector<Vec3> limit(std::span<const Vec3> fine) const override { return trial_->limit(fine); }
    Parts decompose(std::span<const Vec3> fine) const override;
    std::vector<Vec3> allDetails(std::span<const Vec3> coarse, std::span<const Vec3> stored) const override {
        return trial_->allDetails(coarse, stored);
    }
    std::vector<Vec3> shift(std::span<const Vec3> allDetails) const override;

    // The row of P at a fine vertex, over coarse ones; a vertex's own first.
    void rowOfP(Index fine, Taps& row) const;
    // Vertices at which the trial row stays, corners not counted.
    std::size_t withoutRow() const { return withoutRow_; }

  private:
    WideCatmullClarkStep(const PolygonMesh& coarse, std::unique_ptr<CatmullClarkStep> trial);

    const Adjacency& mesh() const { return trial_->adjacency(); }
    void findKinds(const PolygonMesh& coarse);
    void findRows();
    std::vector<bool> regularVertices() const;
    std::vector<Index> window(Index v) const;
    std::vector<Index> ballWindow(Index v) const;
    std::vector<Index> curveWindow(Index v) const;
    Vec3 regularShift(Index v, std::span<const Vec3> details) const;
    void addFaceRow(Index f, double factor, Taps& row) const;

    std::unique_ptr<CatmullClarkStep> trial_;
    std::vector<bool> sharp_;                  // of each edge
    std::vector<std::vector<Index>> sharpAt_;  // sharp edges of each vertex
    std::vector<bool> corner_, regular_;
    LeastNormRows rows_;
    std::vector<const std::vector<double>*> weights_;  // of each other vertex, on its window; null: no shift
    std::size_t withoutRow_ = 0;
};

}  // namespace isowave::subdivision

#include "io/image/dicom/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/image/check.h"
#include "isowave/error.h"

namespace isowave::imageio {
namespace {

// ---- pixels

std::string bitsProblem(const DicomObject& o) {
    const bool known = o.allocated == 1 || o.allocated == 8 || o.allocated == 12 || o.allocated == 16 ||
                       o.allocated == 32 || o.allocated == 64;
    if (known && o.stored >= 1 && o.stored <= o.allocated && o.highBit >= o.stored - 1 &&
        o.highBit < o.allocated)
        return "";
    return fmt::format(
        "its pixels are said to have {} bits, of which {} are used up to bit {}; expected 1, 8, 12, 16, "
        "32 or 64",
        o.allocated, o.stored, o.highBit);
}

ValueType typeOf(const DicomObject& o, bool isSigned) {
    if (o.file.pixelTag == tag::kFloatPixels.number) return ValueType::float32;
    if (o.file.pixelTag == tag::kDoublePixels.number) return ValueType::float64;
    switch (o.allocated) {
        case 1:
        case 8:
            return isSigned ? ValueType::int8 : ValueType::uint8;
        case 32:
            return isSigned ? ValueType::int32 : ValueType::uint32;
        case 64:
            return isSigned ? ValueType::int64 : ValueType::uint64;
        default:
            return isSigned ? ValueType::int16 : ValueType::uint16;
    }
}

// Whether the file holds as many pixels as it says, or pieces of compressed ones.
std::string lengthProblem(const DicomObject& o) {
    const std::string says = fmt::format("{} x {}{} pixels", o.columns, o.rows,
                                         o.frames > 1 ? fmt::format(" x {}", o.frames) : std::string());
    const auto pieces = static_cast<std::int64_t>(std::max(o.file.fragments.size(), o.file.offsets.size()));
    if (o.file.encapsulated)
        return pieces > 0 && (o.frames == 1 || o.frames <= pieces)
                   ? ""
                   : fmt::format("says {} but holds {} compressed pieces; it is truncated or damaged", says,
                                 pieces);
    const double needed =
        std::ceil(static_cast<double>(o.pixels()) * static_cast<double>(o.frames) * o.allocated / 8);
    const auto held = static_cast<double>(o.file.pixels.length);
    return held >= needed ? ""
                          : fmt::format("says {} ({}) but holds {}; it is truncated or its header is wrong",
                                        says, bytesText(needed), bytesText(held));
}

std::string pixelProblem(const DicomObject& o, double samples) {
    if (!o.file.problem.empty()) return o.file.problem;
    if (samples != 1)
        return fmt::format("holds colours ({} samples a pixel); expected one number a voxel", samples);
    if (o.colour == "PALETTE COLOR") return "holds colours (PALETTE COLOR); expected one number a voxel";
    if (o.frames < 1) return fmt::format("says that it holds {} frames; expected one or more", o.frames);
    // Slides of microscopes, and their segmentations: one large plane, of which each frame is a piece.
    if (o.frames > 1 && o.file.set.number(tag::kMatrixColumns))
        return fmt::format(
            "its {} frames are tiles of one plane ({} says {:g}), not slices; expected a volume", o.frames,
            tag::kMatrixColumns.name, *o.file.set.number(tag::kMatrixColumns));
    if (std::string bits = bitsProblem(o); !bits.empty()) return bits;
    return lengthProblem(o);
}

// A number that must be whole and fit; anything else becomes -1, which is refused where it matters.
std::int64_t whole(const DicomSet& set, const DicomTag& tag, std::int64_t otherwise) {
    const double value = set.number(tag, static_cast<double>(otherwise));
    return value == std::floor(value) && std::abs(value) < 1e9 ? static_cast<std::int64_t>(value) : -1;
}

DicomObject objectOf(DicomFile& file) {
    const DicomSet& set = file.set;
    DicomObject o;
    o.seriesUid = set.text(tag::kSeries);
    o.description = oneLine(set.text(tag::kDescription));
    o.studyUid = set.text(tag::kStudy);
    o.frameOfReference = set.text(tag::kFrameOfReference);
    o.instanceUid = set.text(tag::kSopInstance);
    o.modality = oneLine(set.text(tag::kModality));
    o.colour = oneLine(set.text(tag::kColour));
    o.rows = whole(set, tag::kRows, 0);
    o.columns = whole(set, tag::kColumns, 0);
    o.frames = whole(set, tag::kFrames, 1);
    if (!set.number(tag::kFrames) || o.frames == 0) o.frames = 1;
    const bool floating =
        file.pixelTag == tag::kFloatPixels.number || file.pixelTag == tag::kDoublePixels.number;
    const int usual = file.pixelTag == tag::kFloatPixels.number ? 32 : floating ? 64 : 16;
    o.allocated = static_cast<int>(floating ? usual : whole(set, tag::kAllocated, usual));
    o.stored = static_cast<int>(floating ? usual : whole(set, tag::kStored, o.allocated));
    o.highBit = static_cast<int>(floating ? usual - 1 : whole(set, tag::kHighBit, o.stored - 1));
    for (const DicomSet& segment : set.items(tag::kSegments))
        o.segments.push_back(fmt::format("{} '{}'", segment.number(tag::kSegmentNumber, 0),
                                         oneLine(segment.text(tag::kSegmentLabel))));
    o.isLabelMap = set.text(tag::kSegmentationType) == "LABELMAP";
    if (o.isLabelMap) o.background = set.number(tag::kPadding);
    if (set.text(tag::kSegmentationType) == "FRACTIONAL" && o.allocated > 1) {
        o.mostFraction = std::max(1.0, set.number(tag::kMostFraction, 255));
        o.remarks.push_back("its values are shares of a voxel, 0 to 1; half of it is --iso 0.5");
    }
    if (set.item(tag::kModalityLut))
        o.remarks.push_back("its ModalityLUTSequence is not applied; values are as stored");
    o.file = std::move(file);
    o.type = typeOf(o, o.file.set.number(tag::kRepresentation, 0) == 1);
    o.problem = pixelProblem(o, o.file.set.number(tag::kSamples, 1));
    return o;
}

// ---- what a frame says of itself

// Its own functional groups, the shared ones, the top of the data set.
struct Scope {
    const DicomSet& top;
    const DicomSet* shared = nullptr;
    const DicomSet* own = nullptr;

    const DicomSet* group(const DicomTag& sequence) const {
        const DicomSet* found = own ? own->item(sequence) : nullptr;
        return found || !shared ? found : shared->item(sequence);
    }
    // The set in which the element stands, or nullptr.
    const DicomSet* holder(const DicomTag& sequence, const DicomTag& tag) const {
        const DicomSet* in = group(sequence);
        if (in && !in->text(tag).empty()) return in;
        return top.text(tag).empty() ? nullptr : &top;
    }
    std::vector<double> numbers(const DicomTag& sequence, const DicomTag& tag) const {
        const DicomSet* in = holder(sequence, tag);
        return in ? in->numbers(tag) : std::vector<double>();
    }
    double number(const DicomTag& sequence, const DicomTag& tag, double otherwise) const {
        const std::vector<double> all = numbers(sequence, tag);
        return all.empty() ? otherwise : all[0];
    }
};

[[noreturn]] void throwCount(const DicomFrame& frame, const DicomTag& tag, std::size_t found,
                             std::size_t expected) {
    throw InputError(frame.object->file.path.string(),
                     fmt::format("{} has {} numbers; expected {}", tag.name, found, expected));
}

// The first of these that the frame holds: of patients, of volumes (ultrasound), of a detector (nuclear medicine).
struct Place {
    const DicomTag &sequence, &tag;
};

void takePosition(const Scope& scope, DicomFrame& frame) {
    for (const Place& p :
         {Place{tag::kPlanePosition, tag::kPosition}, Place{tag::kPlanePositionVolume, tag::kVolumePosition},
          Place{tag::kDetector, tag::kPosition}}) {
        const DicomSet* in = scope.holder(p.sequence, p.tag);
        if (!in && &p.sequence == &tag::kDetector) in = scope.top.item(tag::kDetector);
        const std::vector<double> v = in ? in->numbers(p.tag) : std::vector<double>();
        if (v.empty()) continue;
        if (v.size() != 3) throwCount(frame, p.tag, v.size(), 3);
        frame.position = Vec3{v[0], v[1], v[2]};
        return;
    }
}

void takeOrientation(const Scope& scope, DicomFrame& frame) {
    for (const Place& p : {Place{tag::kPlaneOrientation, tag::kOrientation},
                           Place{tag::kPlaneOrientationVolume, tag::kVolumeOrientation},
                           Place{tag::kDetector, tag::kOrientation}}) {
        const DicomSet* in = scope.holder(p.sequence, p.tag);
        if (!in && &p.sequence == &tag::kDetector) in = scope.top.item(tag::kDetector);
        const std::vector<double> v = in ? in->numbers(p.tag) : std::vector<double>();
        if (v.empty()) continue;
        if (v.size() != 6) throwCount(frame, p.tag, v.size(), 6);
        const Vec3 row{v[0], v[1], v[2]}, column{v[3], v[4], v[5]};
        if (!(length(cross(row, column)) > 1e-3 * length(row) * length(column)) || !(length(row) > 0))
            throw InputError(frame.object->file.path.string(),
                             "its rows and columns run the same way (ImageOrientationPatient)");
        // Cosines are rounded to six digits or so; ITK makes them unit vectors again, and so do we.
        frame.row = row / length(row);
        frame.column = column / length(column);
        return;
    }
}

void takeSpacing(const Scope& scope, DicomFrame& frame) {
    for (const DicomTag* tag : {&tag::kPixelSpacing, &tag::kNominalSpacing, &tag::kImagerSpacing}) {
        const std::vector<double> v = scope.numbers(tag::kPixelMeasures, *tag);
        if (v.empty()) continue;
        if (v.size() != 2) throwCount(frame, *tag, v.size(), 2);
        frame.spacing = {v[1], v[0]};  // first down the columns, then along the rows
        frame.spacingFrom = tag->name;
        return;
    }
}

// Where a scale is not said it is 1, and a scale of 0, which would leave nothing, is taken for not said.
void takeValues(const Scope& scope, DicomObject& object, DicomFrame& frame) {
    const double whole = frame.object->mostFraction;
    frame.slope = whole > 0 ? 1 / whole : scope.number(tag::kValueTransformation, tag::kSlope, 1);
    frame.intercept = scope.number(tag::kValueTransformation, tag::kIntercept, 0);
    if (const auto dose = scope.top.number(tag::kDoseScaling)) {
        frame.slope = *dose;
        frame.intercept = 0;
    }
    if (frame.slope == 0) {
        frame.slope = 1;
        frame.intercept = 0;
        const std::string remark = "its slope is said to be 0; the stored values are kept";
        if (std::find(object.remarks.begin(), object.remarks.end(), remark) == object.remarks.end())
            object.remarks.push_back(remark);
    }
    if (!std::isfinite(frame.slope) || !std::isfinite(frame.intercept))
        throw InputError(
            frame.object->file.path.string(),
            fmt::format("its values are said to be {} times the stored ones plus {}; expected numbers",
                        frame.slope, frame.intercept));
}

void addMoment(const DicomSet* set, const DicomTag& tag, DicomFrame& frame) {
    if (!set) return;
    const std::string_view vr = tag.vr;
    if (vr == "TM") {
        const std::string text = set->text(tag);
        if (!text.empty())
            frame.moments.push_back({tag.name, oneLine(text), std::strtod(text.c_str(), nullptr)});
        return;
    }
    for (const double value : set->numbers(tag))
        frame.moments.push_back({tag.name, fmt::format("{:g}", value), value});
}

// In the order in which they tell volumes apart; the last two always differ.
void takeMoments(const Scope& scope, DicomFrame& frame) {
    const DicomSet* content = scope.group(tag::kFrameContent);
    addMoment(content, tag::kTemporalIndex, frame);
    addMoment(&scope.top, tag::kTemporalPosition, frame);
    addMoment(&scope.top, tag::kAcquisition, frame);
    addMoment(&scope.top, tag::kEchoTime, frame);
    addMoment(scope.group(tag::kMrEcho), tag::kEffectiveEchoTime, frame);
    addMoment(scope.group(tag::kMrDiffusion), tag::kDiffusion, frame);
    addMoment(&scope.top, tag::kDiffusion, frame);
    addMoment(&scope.top, tag::kInversionTime, frame);
    addMoment(&scope.top, tag::kTriggerTime, frame);
    addMoment(&scope.top, tag::kAcquisitionTime, frame);
    addMoment(&scope.top, tag::kContentTime, frame);
    addMoment(content, tag::kDimensionIndex, frame);
    addMoment(&scope.top, tag::kInstance, frame);
    frame.moments.push_back({"frame", std::to_string(frame.index + 1), static_cast<double>(frame.index)});
}

DicomFrame frameIn(const Scope& scope, const std::shared_ptr<DicomObject>& object, std::int64_t index) {
    DicomFrame frame;
    frame.object = object;
    frame.index = index;
    takePosition(scope, frame);
    takeOrientation(scope, frame);
    takeSpacing(scope, frame);
    takeValues(scope, *object, frame);
    takeMoments(scope, frame);
    frame.thickness = std::abs(scope.number(tag::kPixelMeasures, tag::kThickness, 0));
    frame.between = scope.number(tag::kPixelMeasures, tag::kBetween, 0);
    frame.location = scope.top.number(tag::kLocation);
    frame.instance = scope.top.number(tag::kInstance);
    if (const DicomSet* content = scope.group(tag::kFrameContent))
        frame.stackId = content->text(tag::kStackId);
    if (const DicomSet* segment = scope.group(tag::kSegmentation))
        frame.segment = static_cast<int>(segment->number(tag::kReferencedSegment, 0));
    return frame;
}

// ---- frames of which the file says one place for all

// The offsets of the frames along the normal that a vector of the file says.
struct Offsets {
    std::vector<double> mm;
    bool alongZ = false;  // they are z, whichever way the normal points
};

std::optional<Offsets> saidOffsets(const DicomSet& set, const DicomObject& object) {
    for (const DicomTag* tag : {&tag::kFrameOffsets, &tag::kLocationVector}) {
        Offsets offsets{set.numbers(*tag)};
        if (offsets.mm.empty()) continue;
        if (static_cast<std::int64_t>(offsets.mm.size()) != object.frames)
            throw InputError(
                object.file.path.string(),
                fmt::format("{} has {} numbers for {} frames", tag->name, offsets.mm.size(), object.frames));
        // PS3.3 C.8.8.3.2: offsets begin with 0, or they are the z of the frames.
        const double first = offsets.mm[0];
        offsets.alongZ = tag == &tag::kFrameOffsets && first != 0;
        for (double& mm : offsets.mm) mm -= first;
        return offsets;
    }
    return std::nullopt;
}

// Nuclear medicine: which slice each frame is, from 1 on.
std::optional<Offsets> slicesOfVector(const DicomSet& set, const DicomObject& object, double step) {
    const std::vector<double> slices = set.numbers(tag::kSliceVector);
    if (static_cast<std::int64_t>(slices.size()) != object.frames || step == 0) return std::nullopt;
    Offsets offsets;
    for (const double slice : slices) offsets.mm.push_back((slice - 1) * step);
    return offsets;
}

bool pointsAt(const DicomSet& set, const DicomTag& tag) {
    const std::vector<double> all = set.numbers(tag::kFramePointer);
    return std::find(all.begin(), all.end(), static_cast<double>(tag.number)) != all.end();
}

// What FrameIncrementPointer names when that is an energy, a detector, a rotation or a time of nuclear medicine (group
// 0054) and no slice; 0 otherwise.
std::uint32_t nuclearPointer(const DicomSet& set) {
    if (pointsAt(set, tag::kSliceVector)) return 0;
    for (const double named : set.numbers(tag::kFramePointer))
        if (static_cast<std::uint32_t>(named) >> 16 == 0x0054) return static_cast<std::uint32_t>(named);
    return 0;
}

// Why frames are times rather than slices; "" when they are not. What FrameIncrementPointer names is what a step from
// frame to frame is; files without one that say how fast a film runs, and no distance, are films too.
std::string filmProblem(const DicomSet& set, const DicomFrame& frame) {
    const auto film = [&](const std::string& why) {
        return fmt::format("its {} frames are times ({}), not slices; a film is no volume",
                           frame.object->frames, why);
    };
    for (const DicomTag* tag : {&tag::kFrameTime, &tag::kFrameTimeVector, &tag::kTriggerTime})
        if (pointsAt(set, *tag)) return film(fmt::format("FrameIncrementPointer names {}", tag->name));
    if (const std::uint32_t named = nuclearPointer(set))
        return film(fmt::format("or views: FrameIncrementPointer names (0054,{:04x})", named & 0xFFFF));
    if (set.has(tag::kFramePointer) || frame.between != 0) return "";
    for (const DicomTag* tag : {&tag::kFrameTime, &tag::kFrameTimeVector, &tag::kCineRate})
        if (set.number(*tag))
            return film(
                fmt::format("{} says {:g}, and nothing says their distance", tag->name, *set.number(*tag)));
    return "";
}

void takeVectorMoments(const DicomSet& set, std::vector<DicomFrame>& frames) {
    for (const DicomTag* tag : {&tag::kTimeSlotVector, &tag::kTimeSliceVector}) {
        const std::vector<double> all = set.numbers(*tag);
        if (all.size() != frames.size()) continue;
        for (std::size_t i = 0; i < all.size(); ++i)
            frames[i].moments.insert(frames[i].moments.begin(),
                                     {tag->name, fmt::format("{:g}", all[i]), all[i]});
    }
}

void putAt(const Offsets& offsets, std::vector<DicomFrame>& frames) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
        DicomFrame& frame = frames[i];
        frame.location = offsets.mm[i];
        frame.instance = static_cast<double>(i);
        if (!frame.placed()) continue;
        const Vec3 normal = frame.normal();
        const bool z = offsets.alongZ && std::abs(normal.z) > 0.999;
        *frame.position += (z ? Vec3{0, 0, 1} : normal) * offsets.mm[i];
    }
}

// Step by step along the normal; object: that of all frames, for its remarks.
void layFrames(const DicomSet& set, DicomObject& object, std::vector<DicomFrame>& frames) {
    const DicomFrame& first = frames[0];
    const bool nuclear = object.modality == "NM" || object.modality == "PT";
    double step = nuclear ? first.between : std::abs(first.between);
    takeVectorMoments(set, frames);
    if (const auto said = saidOffsets(set, object)) return putAt(*said, frames);
    if (const auto slices = slicesOfVector(set, object, step)) return putAt(*slices, frames);
    if (object.problem.empty()) object.problem = filmProblem(set, first);
    const bool assumed = step == 0 && first.thickness == 0;
    if (step == 0 && !assumed) {
        step = first.thickness;
        object.remarks.push_back(
            fmt::format("the distance of its frames is not said; their thickness, {:g} mm, is taken", step));
    }
    if (assumed) step = first.spacing ? (*first.spacing)[0] : 1;
    Offsets offsets;
    for (std::size_t i = 0; i < frames.size(); ++i) offsets.mm.push_back(static_cast<double>(i) * step);
    putAt(offsets, frames);
    for (DicomFrame& frame : frames) frame.stepAssumed = assumed;
}

void checkGroups(const DicomObject& object, const std::vector<DicomSet>& groups) {
    if (!groups.empty() && static_cast<std::int64_t>(groups.size()) != object.frames)
        throw InputError(object.file.path.string(),
                         fmt::format("says that it holds {} frames but describes {} "
                                     "(PerFrameFunctionalGroupsSequence); it is damaged",
                                     object.frames, groups.size()));
}

void checkPlaced(const std::vector<DicomFrame>& frames) {
    for (const DicomFrame& frame : frames)
        if (frame.placed() != frames[0].placed())
            throw InputError(
                frame.object->file.path.string(),
                fmt::format("frame {} says where it lies but frame {} does not; it is damaged",
                            frame.placed() ? frame.index + 1 : 1, frame.placed() ? 1 : frame.index + 1));
}

}  // namespace

std::string DicomFrame::name() const {
    const std::string file = object->file.path.filename().string();
    return object->frames > 1 ? fmt::format("{} frame {}", file, index + 1) : file;
}

std::vector<DicomFrame> framesOf(DicomFile file) {
    const auto object = std::make_shared<DicomObject>(objectOf(file));
    if (object->rows <= 0 || object->columns <= 0 || object->file.pixelTag == 0) {
        // An image whose pixels are gone is no report.
        if (object->rows <= 0 || object->columns <= 0 || object->problem.empty() ||
            object->file.problem.empty())
            return {};
    }
    const DicomSet set = std::move(object->file.set);
    object->file.set = {};
    const std::vector<DicomSet>& groups = set.items(tag::kFrameGroups);
    const std::int64_t count = object->problem.empty() ? object->frames : 1;
    if (object->problem.empty()) checkGroups(*object, groups);
    std::vector<DicomFrame> frames;
    bool own = false;
    for (std::int64_t i = 0; i < count; ++i) {
        Scope scope{set, set.item(tag::kSharedGroups)};
        if (static_cast<std::size_t>(i) < groups.size()) scope.own = &groups[static_cast<std::size_t>(i)];
        own = own || (scope.own &&
                      (scope.own->item(tag::kPlanePosition) || scope.own->item(tag::kPlanePositionVolume)));
        frames.push_back(frameIn(scope, object, i));
    }
    const bool sharedPlace = set.item(tag::kSharedGroups) &&
                             set.item(tag::kSharedGroups)->item(tag::kPlanePosition) && !groups.empty();
    if (count > 1 && !own && !sharedPlace) layFrames(set, *object, frames);
    checkPlaced(frames);
    return frames;
}

}  // namespace isowave::imageio

"""A ladder as a table for notebooks: it takes its colours from the page, so that it can be read on dark and on light."""

from __future__ import annotations

from html import escape
from typing import Any, Optional, Sequence

__all__ = ["grouped", "ladder_html", "short", "table"]

_STYLE = (
    "<style scoped>"
    ".isowave{border-collapse:collapse;font-variant-numeric:tabular-nums;color:inherit}"
    ".isowave caption{caption-side:top;text-align:left;padding:0 0 .4em;color:inherit}"
    ".isowave th,.isowave td{padding:.25em .8em;text-align:right;border:0;border-bottom:1px solid rgba(128,128,128,.35);"
    "background:none;white-space:nowrap}"
    ".isowave th{font-weight:600;border-bottom:1px solid rgba(128,128,128,.9)}"
    ".isowave th:first-child,.isowave td:first-child{text-align:left}"
    "</style>"
)


def short(value: Optional[float]) -> str:
    """Four digits; a dash where there is no number.

    >>> short(1234.5678), short(0.00012345), short(None)
    ('1,235', '0.0001234', '–')
    """
    if value is None:
        return "–"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"


def grouped(value: Optional[int]) -> str:
    return "–" if value is None else f"{value:,}"


def _percent(value: Optional[float]) -> str:
    return "–" if value is None else f"{100 * value:+.3g} %".replace("-", "−")


def table(caption: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in header)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return (
        f'{_STYLE}<table class="isowave"><caption>{escape(caption)}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def _name(report: dict[str, Any]) -> str:
    if "why" not in report:
        return str(report["level"]) if report["level"] is not None else f"step {report['step']}"
    for key, form in (
        ("ratio_asked", "at most {:.4g} of the triangles"),
        ("triangles_asked", "at most {:,} triangles"),
        ("tolerance_asked", "within {:.4g}"),
    ):
        if report[key] is not None:
            return form.format(report[key]) + f" (step {report['step']})"
    return f"step {report['step']}"


def _voxel(spacing: Optional[Sequence[float]]) -> str:
    if spacing is None:
        return "–"
    texts = [short(s) for s in spacing]
    return texts[0] if len(set(texts)) == 1 else " × ".join(texts)


def _row(report: dict[str, Any]) -> list[str]:
    return [
        _name(report),
        _voxel(report.get("spacing")),
        grouped(report["triangles"]),
        grouped(report.get("parts", report["components"])),
        grouped(report["genus"]),
        grouped(report.get("cavities")),
        short(report["volume"]),
        _percent(report.get("volume_error")),
        short(report["rms_to_level0"]),
        short(report["max_to_level0"]),
    ]


def ladder_html(reports: Sequence[dict[str, Any]], name: str, unit: str) -> str:
    """unit: of lengths; empty where it is not known."""
    of_length, of_volume = (f" [{unit}]", f" [{unit}³]") if unit else ("", "")
    header = [
        "level",
        "voxel" + of_length,
        "triangles",
        "parts",
        "handles",
        "cavities",
        "volume" + of_volume,
        "volume error",
        "rms to level 0" + of_length,
        "max to level 0" + of_length,
    ]
    return table(f"{name}: {len(reports)} meshes", header, [_row(report) for report in reports])

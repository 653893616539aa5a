// SPDX-License-Identifier: MIT
#include "html_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "assets/print.hpp"

namespace crofton::cli {
namespace {

constexpr double kWidth = 640.0, kHeight = 240.0, kLeft = 88.0, kRight = 12.0, kTop = 12.0, kBottom = 28.0;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", value);
    return text;
}

// The smallest of 1, 2, 5 times a power of ten that makes at most five steps up to `highest`.
double step_for(double highest) {
    if (!(highest > 0.0)) return 1.0;
    const double power = std::pow(10.0, std::floor(std::log10(highest / 5.0)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (highest <= 5.0 * factor * power) return factor * power;
    return 10.0 * power;
}

std::string label(double x, double y, const char* anchor, const std::string& text) {
    return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\">" + text + "</text>";
}

}  // namespace

std::string readable(double value) {
    char text[64];
    if (std::fabs(value) >= 100.0 && std::fabs(value) < 1e15) value = std::round(value);
    if (value != std::floor(value) || std::fabs(value) >= 1e15) {
        std::snprintf(text, sizeof text, std::fabs(value) >= 100.0 ? "%.0f" : "%.3g", value);
        return text;
    }
    std::snprintf(text, sizeof text, "%.0f", value);
    std::string grouped;
    const std::string digits = text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && digits[i - 1] != '-' && (digits.size() - i) % 3 == 0) grouped += "&#8239;";
        grouped += digits[i];
    }
    return grouped;
}

std::string svg_chart(const std::string& id, const std::string& title, const std::string& unit,
                      const std::vector<Series>& series) {
    double highest = 0.0;
    std::size_t count = 0;
    for (const Series& s : series) {
        count = std::max(count, s.values.size());
        for (const double value : s.values) highest = std::max(highest, value);
    }
    const double step = step_for(highest), top = std::max(step, std::ceil(highest / step) * step);
    const auto x_of = [&](std::size_t i) {
        return kLeft + (kWidth - kLeft - kRight) * static_cast<double>(i) /
                           std::max<double>(1.0, static_cast<double>(count) - 1.0);
    };
    const auto y_of = [&](double value) { return kHeight - kBottom - (kHeight - kTop - kBottom) * value / top; };

    std::string html =
        "<figure class=\"chart\" id=\"" + id + "\"><figcaption>" + markup_text(title) + " <small>" + markup_text(unit) +
        "</small></figcaption><svg viewBox=\"0 0 640 240\" role=\"img\" aria-label=\"" + markup_text(title) + "\">";
    for (double value = 0.0; value <= top * 1.0001; value += step) {
        html += "<line class=\"grid\" x1=\"" + number(kLeft) + "\" x2=\"" + number(kWidth - kRight) + "\" y1=\"" +
                number(y_of(value)) + "\" y2=\"" + number(y_of(value)) + "\"/>";
        html += label(kLeft - 6.0, y_of(value) + 4.0, "end", readable(value));
    }
    const std::size_t last = count > 0 ? count - 1 : 0;
    for (const std::size_t i : {std::size_t{0}, last / 2, last})
        html += label(x_of(i), kHeight - 8.0,
                      i == 0      ? "start"
                      : i == last ? "end"
                                  : "middle",
                      readable(static_cast<double>(i)));
    std::string legend;
    for (std::size_t s = 0; s < series.size(); ++s) {
        const std::string style = "s" + std::to_string(s);
        std::string points;
        double sum = 0.0;
        for (std::size_t i = 0; i < series[s].values.size(); ++i) {
            points += number(x_of(i)) + "," + number(y_of(series[s].values[i])) + " ";
            sum += series[s].values[i];
        }
        html += "<polyline class=\"" + style + "\" points=\"" + points + "\"/>";
        const double mean = series[s].values.empty() ? 0.0 : sum / static_cast<double>(series[s].values.size());
        legend += "<li class=\"" + style + "\"><i></i>" + markup_text(series[s].name) + " <small>mean " +
                  readable(mean) + "</small></li>";
    }
    return html + "</svg><ul>" + legend + "</ul></figure>\n";
}

}  // namespace crofton::cli

#!/usr/bin/python3
"""Draws identifications as one self-contained HTML page, from the files that `servomill identify --signals` and
`servomill response --signals` write.

    tools/identification_page.py SIGNALS.h5... [-o PAGE.html] [--force]

Values with their intervals, measured against simulated signals, the residual and its colour, the correlation of the values, friction
laws, validation recordings and frequency responses with their 95 % bands as far as the files hold them. Exit status: 0 written, 2 a
file cannot be read or written.
"""
import argparse
import base64
import html
import io
import os
import sys

import h5py
import matplotlib
import numpy as np

from command_line import InputError, run

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

MEASURED, SIMULATED, LIMIT = "#1f77b4", "#d62728", "#7f7f7f"
MOST_POINTS = 4000  # of a curve: more cannot be seen
STYLE = """body{font:15px/1.45 sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;margin:1em 0}td,th{padding:.25em .8em;border-bottom:1px solid #ccc;text-align:right}
td:first-child,th:first-child{text-align:left}img{max-width:100%}h2{margin-top:2em}.no{color:#b00}"""


def thinned(x):
    """A slice that keeps at most MOST_POINTS."""
    return slice(None, None, max(1, -(-len(x) // MOST_POINTS)))


def picture(figure, caption):
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=110, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)
    text = base64.b64encode(out.getvalue()).decode()
    return f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{text}"><figcaption>{html.escape(caption)}</figcaption></figure>'


def table(head, rows):
    def cells(tag, row):
        return "".join(f"<{tag}>{cell}</{tag}>" for cell in row)
    return f"<table><tr>{cells('th', head)}</tr>" + "".join(f"<tr>{cells('td', row)}</tr>" for row in rows) + "</table>"


def parameters(group):
    """Key, unit, identifiable, value, half-width, half-width by counting, one row a parameter."""
    count = len(group["value"]) if "value" in group else 0
    text = [[group.attrs[f"{name}_{k:02}"] for name in ("key", "unit", "identifiable")] for k in range(count)]
    numbers = np.column_stack([group[name][:] for name in ("value", "half_width", "half_width_counted")]) if count else []
    return [(*words, *values) for words, values in zip(text, numbers)]


def value_table(rows):
    body = []
    for key, unit, identifiable, value, half, counted in rows:
        unit = "" if unit == "1" else html.escape(unit)
        if identifiable != "yes":
            body.append((html.escape(key), f"{value:.5g}", '<span class="no">cannot be identified</span>', unit, "", ""))
            continue
        share = f"{100 * half / abs(value):.2g} %" if value else ""
        body.append((html.escape(key), f"{value:.6g}", f"{half:.2g}", unit, share, f"{counted:.2g}"))
    return table(("parameter", "value", "&plusmn; (k = 2)", "unit", "relative", "counting samples"), body)


def correlation(group, rows):
    covariance = group["covariance"][:]
    known = [k for k, row in enumerate(rows) if row[2] == "yes" and covariance[k, k] > 0]
    if len(known) < 2:
        return ""
    part = covariance[np.ix_(known, known)]
    deviation = np.sqrt(np.diag(part))
    figure, axes = plt.subplots(figsize=(1.2 + 0.65 * len(known), 1 + 0.6 * len(known)))
    drawn = axes.imshow(part / np.outer(deviation, deviation), vmin=-1, vmax=1, cmap="RdBu_r")
    names = [rows[k][0].split(".", 2)[-1] for k in known]
    axes.set_xticks(range(len(known)), names, rotation=60, ha="right")
    axes.set_yticks(range(len(known)), names)
    figure.colorbar(drawn, ax=axes, label="correlation")
    return picture(figure, "Correlation of the identified values")


def scaled(unit):
    """Factor and name of a unit in which a residual is read."""
    return {"m": (1e6, "um"), "rad": (1e6, "urad")}.get(unit, (1.0, unit))


def motion(group):
    t = group["time"][:]
    unit = group["feedback"].attrs["units"]
    factor, name = scaled(unit)
    some = thinned(t)
    has_command, has_force = "command" in group, "force" in group
    figure, axes = plt.subplots(1 + has_command + has_force, 1, figsize=(10, 2.6 * (1 + has_command + has_force)), sharex=True, squeeze=False)
    axes = list(axes[:, 0])
    if has_command:
        axis = axes.pop(0)
        for signal, colour, label in (("feedback", MEASURED, "measured"), ("simulated_feedback", SIMULATED, "simulated")):
            axis.plot(t[some], factor * (group["command"][some] - group[signal][some]), colour, lw=0.8, label=label)
        axis.set_ylabel(f"command less\nfeedback / {name}")
        axis.legend(loc="upper right")
    axis = axes.pop(0)
    axis.plot(t[some], factor * group["residual"][some], "#444", lw=0.6)
    axis.set_ylabel(f"residual / {name}")
    if has_force:
        axis = axes.pop(0)
        axis.plot(t[some], group["force"][some], MEASURED, lw=0.8, label="measured")
        axis.plot(t[some], group["simulated_force"][some], SIMULATED, lw=0.8, label="simulated")
        axis.set_ylabel(f"force / {group['force'].attrs['units']}")
        axis.legend(loc="upper right")
    axis.set_xlabel("time / s")
    return picture(figure, "Measured and simulated: what the axis lags behind its command, the residual, the force")


def colour(group):
    """Autocorrelation of the residual, and that of the process which the intervals are computed with."""
    lag, model = group["lag"][:], group["residual_autocovariance"][:]
    residual = group["residual"][:]
    count = min(len(lag), len(residual) // 2)
    shown = min(count, max(20, int(np.argmax(np.abs(model) < 0.02 * model[0]) or count) * 3))
    size = 2 ** int(np.ceil(np.log2(2 * len(residual))))
    power = np.abs(np.fft.rfft(residual, size)) ** 2
    found = np.fft.irfft(power)[:shown] / len(residual)
    figure, axis = plt.subplots(figsize=(10, 2.8))
    axis.plot(1e3 * lag[:shown], found / found[0], MEASURED, label="of the residual")
    axis.plot(1e3 * lag[:shown], model[:shown] / model[0], SIMULATED, label="autoregressive, corrected for the fit")
    axis.axhline(0, color=LIMIT, lw=0.5)
    axis.set(xlabel="lag / ms", ylabel="autocorrelation")
    axis.legend()
    return picture(figure, "Colour of the residual: independent samples would be 0 from the first lag on")


def laws(group):
    names = [group.attrs[f"law_{k:02}"] for k in range(len(group["law"]))]
    fitted = [k for k in range(len(names)) if group["rms"][k] > 0]
    rows = [(html.escape(names[k]), int(group["parameters"][k]), f"{1e6 * group['rms'][k]:.3f}", f"{1e6 * group['held_out_rms'][k]:.3f}",
             f"{1e6 * group['held_out_error'][k]:.3f}", f"{group['bic'][k]:.0f}") for k in fitted]
    figure, axis = plt.subplots(figsize=(10, 0.5 + 0.38 * len(fitted)))
    axis.barh(range(len(fitted)), 1e6 * group["held_out_rms"][:][fitted], xerr=2e6 * group["held_out_error"][:][fitted], color=MEASURED)
    axis.set_yticks(range(len(fitted)), [names[k] for k in fitted])
    axis.invert_yaxis()
    axis.set_xlabel("rms of segments excluded from the fit / um")
    return table(("friction law", "parameters", "rms / um", "held out / um", "&plusmn; / um", "BIC"), rows) + \
        picture(figure, "Friction laws by the parts of the recordings that their fit did not see, with two standard errors")


def response_in(group):
    """Frequency and complex response."""
    return group["frequency"][:], group["real"][:] + 1j * group["imaginary"][:]


def band(axis, f, low, high):
    axis.fill_between(f, low, high, color=MEASURED, alpha=0.25, lw=0, label="95 % of the measured")


def draw_phase(axis, f, measured, radius, model):
    """The phase lies within asin(radius / magnitude); where the circle holds the origin it is not known."""
    angle = np.unwrap(np.angle(measured))
    size = np.abs(measured)
    half = np.where(radius < size, np.arcsin(np.minimum(radius / np.maximum(size, 1e-300), 1)), np.pi)
    band(axis, f, np.degrees(angle - half), np.degrees(angle + half))
    axis.plot(f, np.degrees(angle), MEASURED, lw=0.8)
    if model is not None:
        near = np.angle(measured * np.conj(np.interp(f, model[0], model[1])))
        axis.plot(f, np.degrees(angle - near), SIMULATED, lw=1)
    axis.set_ylabel("phase / deg")


def frequency_response_figure(group, model, unit, names):
    """Magnitude and phase with their bands and, with a model (frequency, response), the misfit as a share of the band."""
    f, measured = response_in(group)
    radius = group["radius_95"][:]
    size = np.abs(measured)
    figure, axes = plt.subplots(3 if model else 2, 1, figsize=(10, 8 if model else 6), sharex=True)
    floor = 0.5 * size[size > 0].min(initial=np.inf)
    band(axes[0], f, np.maximum(size - radius, floor), size + radius)
    axes[0].plot(f, size, MEASURED, lw=0.8, label="measured")
    if model:
        axes[0].plot(model[0], np.abs(model[1]), SIMULATED, lw=1, label=names[1])
    axes[0].set(xscale="log", yscale="log", title=names[0], ylabel="magnitude" + ("" if unit == "unknown" else f" / {unit}"))
    axes[0].legend()
    draw_phase(axes[1], f, measured, radius, model)
    if model:
        misfit = np.abs(np.interp(f, *model) - measured)
        axes[2].plot(f, misfit / np.maximum(radius, 1e-300), "#444", lw=0.8)
        axes[2].axhline(1, color=LIMIT, lw=0.8)
        axes[2].set(yscale="log", ylabel="misfit over\n95 % radius")
    axes[-1].set_xlabel("frequency / Hz")
    return figure


def frequency_response(group, model, unit, names):
    figure = frequency_response_figure(group, model, unit, names)
    return picture(figure, f"Frequency response of {names[0]}, measured with 95 % bands" + (f", against {names[1]}" if model else ""))


def response_section(file):
    """A file of `servomill response --signals`."""
    name = os.path.basename(str(file.attrs["name"]))
    signals = f"{file.attrs['input']} to {file.attrs['output']}"
    out = [f"<h2>{html.escape(name)}: {html.escape(signals)}</h2>"]
    model = None
    if "two_mass" in file:
        fit = file["two_mass"]
        values = zip(fit["value"][:], fit["half_width"][:])
        rows = [(html.escape(str(fit.attrs[f"key_{k:02}"])), f"{value:.6g}", f"{half:.2g}", html.escape(str(fit.attrs[f"unit_{k:02}"])))
                for k, (value, half) in enumerate(values)]
        ratio = fit["noise_ratio"][()]
        out += [table(("two masses", "value", "&plusmn; (k = 2)", "unit"), rows),
                f"<p>Median misfit {100 * fit['median_misfit'][()]:.2f} %, {ratio:.1f} times the noise" +
                ("; the uncertainty includes the model error.</p>" if ratio > 1.5 else ".</p>")]
        model = response_in(fit)
    name = "the fitted two masses"
    if "rational" in file:
        fit = file["rational"]
        rows = [(kind.removesuffix("s"), f"{f:.5g}", f"{of_f:.2g}", *(("real", "") if abs(damping) == 1 else (f"{damping:.3g}", f"{of_damping:.2g}")))
                for kind in ("zeros", "poles") if "frequency" in fit[kind]
                for f, of_f, damping, of_damping in zip(*(fit[kind][key][:] for key in ("frequency", "frequency_half_width", "damping",
                                                                                         "damping_half_width")))]
        ratio = fit["noise_ratio"][()]
        out += [table(("rational function", "Hz", "&plusmn; (k = 2)", "damping", "&plusmn; (k = 2)"), rows),
                f"<p>Dead time {1e3 * fit['dead_time'][()]:.4g} ms; median misfit {100 * fit['median_misfit'][()]:.2f} %, {ratio:.1f} times the "
                "noise" + ("; the uncertainty includes the model error.</p>" if ratio > 1.5 else ".</p>")]
        model, name = response_in(fit), "the fitted rational function"
    unit = str(file["response/real"].attrs["units"])
    out.append(frequency_response(file["response"], model, unit, (signals, name)))
    return "\n".join(out)


def identification_section(file):
    """A file of `servomill identify --signals`."""
    title = html.escape(str(file.attrs["name"]))
    rows = parameters(file["parameters"])
    out = [f"<h1>Identification: {title}</h1>",
           "<p>&plusmn; is the expanded uncertainty (k = 2), which takes the autocorrelation of the residual into account; the last "
           "column assumes independent samples.</p>", value_table(rows)]
    if rows:
        out.append(correlation(file["parameters"], rows))
    for name in sorted(key for key in file if key.startswith("recording_")):
        group = file[name]
        factor, unit = scaled(group["feedback"].attrs["units"])
        rms = factor * np.sqrt(np.mean(group["residual"][:] ** 2))
        use = "for validation: the fit has not seen it" if group.attrs["use"] == "validation" else "for estimation"
        out.append(f"<h2>{html.escape(os.path.basename(str(group.attrs['recording'])))}</h2><p>{use}; residual {rms:.3g} {unit} rms</p>")
        out.append(motion(group))
        if "residual_autocovariance" in group:
            out.append(colour(group))
    if "laws" in file:
        out += ["<h2>Friction laws</h2>", laws(file["laws"])]
    return "\n".join(out)


SECTIONS = {"identification": identification_section, "response": response_section}


def section(path):
    """Title and text of what one file holds."""
    try:
        with h5py.File(path) as file:
            draw = SECTIONS.get(file.attrs.get("kind"))
            if draw is None:
                raise InputError(f"identification_page.py: error: {path} is not a file of servomill identify --signals or response --signals")
            return str(file.attrs["name"]), draw(file)
    except OSError as error:
        raise InputError(f"identification_page.py: error: {path}: {error}") from error


def page(files):
    sections = [section(path) for path in files]
    return f"<!DOCTYPE html><html lang=en><meta charset=utf-8><title>{html.escape(sections[0][0])}</title><style>{STYLE}</style>" + \
        "\n".join(text for _, text in sections) + "</html>\n"


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", metavar="SIGNALS.h5", nargs="+")
    parser.add_argument("-o", "--output", metavar="PAGE.html", help="default: beside the first SIGNALS.h5, with the ending .html")
    parser.add_argument("-f", "--force", action="store_true", help="replaces PAGE.html if it exists")
    options = parser.parse_args(arguments)
    out = options.output or os.path.splitext(options.files[0])[0] + ".html"
    if any(os.path.exists(out) and os.path.exists(file) and os.path.samefile(out, file) for file in options.files):
        raise InputError(f"identification_page.py: error: {out} is an input of this command and is never overwritten")
    if os.path.exists(out) and not options.force:
        raise InputError(f"identification_page.py: error: {out} exists; use --force to overwrite")
    text = page(options.files)
    with open(out, "w", encoding="utf-8") as file:
        file.write(text)
    print(f"written to {out}")


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))

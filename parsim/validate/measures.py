"""What is measured of a finished run for its bars: functions of the run and of what `_bars.toml` gives them."""

from parsim.validate import body_measures as bodies
from parsim.validate import exact_measures as exact
from parsim.validate import river_measures as river
from parsim.validate import series_measures as series

MEASURES = {
    function.__name__: function
    for function in (
        bodies.apex, bodies.last_speed, bodies.mean_place, bodies.run_out, bodies.pile_height, bodies.floor_force,
        bodies.carried, bodies.tilt, bodies.rests, bodies.height_over, bodies.drift, series.mean, series.maximum,
        series.minimum, series.last, series.first_over, series.noise_of, series.period_of, series.damping_of,
        series.off_curve, series.balance, series.energy_made, series.growth_over, series.off_log_law,
        series.off_parabola, exact.off_sway, exact.off_couette, river.reach_mean,
        river.reach_most, river.jam_length,
    )
}  # fmt: skip

"""Host times at which a yielding frame turns: the next advance goes on."""

import math

import pytest
import rwmf

DT = 0.02


@pytest.mark.parametrize(
    ("text", "size", "period", "peak"),
    [
        (
            "&wall h=6.020, b=1.538, m_w=1e4 / &frame gamma=3.186, T_s=1.059, xi_s=0.03 /"
            "&yielding u_y=0.0168, law='flag', hardening=0.297 /",
            4.324070218114652,
            0.8619781144749241,
            1.1000437217470564,
        ),
        (
            "&wall h=5.317, b=1.455, m_w=1e4 / &frame gamma=3.338, T_s=0.784, xi_s=0.03 /"
            "&yielding u_y=0.0253, law='elastic_plastic', hardening=0.268 /",
            5.940363600090799,
            1.495666484509546,
            0.7438325636211196,
        ),
        (
            "&wall h=4.059, b=1.060, m_w=1e4 / &frame gamma=3.884, T_s=0.476, xi_s=0.03 /"
            "&yielding u_y=0.0073, law='elastic_plastic', hardening=0.098 /",
            8.026266421611137,
            1.4535813346057207,
            2.980183315810055,
        ),
    ],
)
def test_a_host_time_at_a_peak(text: str, size: float, period: float, peak: float) -> None:
    """The turn leaves less time to the end of the advance than moves the wall by round-off."""

    def ground(t: float) -> float:
        return size * math.sin(2 * math.pi * t / period) if t < 3 * period else 0.0

    case = rwmf.Case.from_text(
        f"{text} &impact rule='constant', e=0.9 / &motion kind='one_sine', a_max_g=0.5, T_p=1.0 /"
        "&solver t_end=8, method='dop853' /"
    )
    with rwmf.Wall(case) as wall:
        t = 0.0
        while t + DT < peak:
            wall.advance_samples((t, t + DT), (ground(t), ground(t + DT)))
            t += DT
        wall.advance_samples((t, peak), (ground(t), ground(peak)))
        saved = wall.save()
        ends = []
        for _ in range(2):
            wall.advance_samples((peak, peak + 0.05), (ground(peak), ground(peak + 0.05)))
            ends.append(wall.state)
            wall.restore(saved)
        assert ends[0] == ends[1]
        assert math.isfinite(ends[0].u_s)

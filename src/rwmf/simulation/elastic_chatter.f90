!> Chatter that hardly loses energy at its impacts, averaged where it is below the resolution.
!>
!> With e near 1 a wall that is pressed down does not come to rest by its impacts: the flights only
!> become shorter by viscous damping, and millions of them may come before the next lift-off. While
!> the pressure changes slowly, the action v**3 (1/a_1 + 1/a_2) of a flight to either side is an
!> adiabatic invariant, v the velocity at impacts and a_1, a_2 the decelerations. Damping d of the
!> acceleration takes d/3 of v per unit of time, because the mean of v**2 over a parabola is a third
!> of its largest value.
module rwmf_simulation_elastic_chatter
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_assembly, only: equation_t, interval_of, second_derivative
   use rwmf_model_energy, only: impact_loss
   use rwmf_model_equation, only: lift_off_drives
   use rwmf_model_lanes, only: of_input, of_viscous, power_count
   use rwmf_model_lift_off, only: drive_turns
   use rwmf_model_rest, only: inverse_inertia
   use rwmf_model_restitution, only: factor_at
   use rwmf_simulation_hybrid_state, only: hybrid_t, mode_rocking
   use rwmf_simulation_recorder_energy_balance, only: add_work
   use rwmf_simulation_recorder_recorder, only: observe_chatter, observe_rest, recorder_t
   implicit none
   private

   public :: skip_chatter, drop_chatter

   real(wp), parameter :: least_flights = 64
   !! that are worth a jump
   real(wp), parameter :: slow = 0.01_wp
   !! largest relative change of a deceleration within a flight [-]
   real(wp), parameter :: most_lost = 0.1_wp
   !! part of the velocity that impacts may take in a jump [-]

contains

   !> Jump over bounces that stay below the resolution, within one monotone piece of the motion.
   subroutine skip_chatter(hybrid, equation, recorder, small_angle, t_limit)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: small_angle
      !! negligible rotation [rad]
      real(wp), intent(in) :: t_limit
      !! end of the interval in force, or of the advance [s]
      real(wp) :: begin(2), pull(2)
      !! decelerations on both sides at the beginning and at the end [rad/s2]
      real(wp) :: v, v_end, e, damping, span, flights
      real(wp) :: gain(3)
      !! logarithm of the energy by ground motion, damping and impacts [-]

      v = abs(hybrid%y(2))
      if (hybrid%mode /= mode_rocking .or. abs(hybrid%y(1)) > 0 .or. v <= 0) return
      if (equation%moves_at_rest) return
      begin = decelerations(equation, hybrid%t)
      if (minval(begin) <= 0) return
      if (v**2 > 2*minval(begin)*small_angle) return
      span = min(t_limit, drive_turns(equation, interval_of(equation), hybrid%t)) - hybrid%t
      if (span < least_flights*2*v/minval(begin)) return
      e = factor_at(hybrid%restitution, v)
      damping = damping_at(hybrid, equation, v)
      do
         pull = decelerations(equation, hybrid%t + span)
         gain(:2) = [log(max(harmonic(pull), tiny(v))/harmonic(begin)), -damping*span]*2/3
         v_end = v*exp((gain(1) + gain(2))/2)
         flights = span*(harmonic(begin)/v + harmonic(pull)/v_end)/2
         if (minval(pull) > 0) then
            associate (rate => maxval(abs(pull - begin))/span)
               if (max(2*v*rate/minval(begin)**2, 2*v_end*rate/minval(pull)**2) <= slow &
                  .and. v_end**2 <= 2*minval(pull)*small_angle .and. abs(gain(2)) <= 1 &
                  .and. flights*(1 - e) <= most_lost) exit
            end associate
         end if
         span = span/2
         if (span < least_flights*2*v/minval(begin)) return
      end do
      gain(3) = 2*flights*log(e)
      call note_jump(hybrid, equation, recorder, span, flights, gain)
   end subroutine skip_chatter

   !> Enter in ledger and warnings the bounces that a wall at rest beside moving floors is spared.
   subroutine drop_chatter(equation, recorder, t, v)
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: v
      !! angular velocity after the last impact [rad/s]

      call observe_chatter(recorder, t, 0_i8)
      if (recorder%keeps_energy) then
         recorder%energy%impact = recorder%energy%impact + impact_loss(equation, v, 0.0_wp)
      end if
   end subroutine drop_chatter

   !> Change state, ledger and counts by the bounces of a jump.
   subroutine note_jump(hybrid, equation, recorder, span, flights, gain)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: span
      !! [s]
      real(wp), intent(in) :: flights
      !! their number
      real(wp), intent(in) :: gain(3)
      real(wp) :: work(power_count), rest(size(hybrid%y)), total, share

      rest = hybrid%y
      rest(:2) = 0
      call observe_rest(recorder, equation, rest, hybrid%t, hybrid%t + span)
      call observe_chatter(recorder, hybrid%t, int(flights, i8))
      total = sum(gain)
      share = impact_loss(equation, hybrid%y(2), 0.0_wp)
      ! (exp(x) - 1)/x by a series where the difference would cancel
      if (abs(total) > 1.0e-4_wp) share = share*(exp(total) - 1)/total
      if (abs(total) <= 1.0e-4_wp) share = share*(1 + total/2*(1 + total/3*(1 + total/4)))
      if (recorder%keeps_energy) then
         work = 0
         work(of_input) = share*gain(1)
         work(of_viscous) = -share*gain(2)
         call add_work(recorder%energy, work)
         recorder%energy%impact = recorder%energy%impact - share*gain(3)
      end if
      hybrid%t = hybrid%t + span
      hybrid%y(2) = hybrid%y(2)*exp(total/2)
      hybrid%flight = 0
   end subroutine note_jump

   !> Angular decelerations of a wall that leaves its base, on both sides [rad/s2].
   function decelerations(equation, t) result(pull)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! in the interval in force [s]
      real(wp) :: pull(2)

      pull = -lift_off_drives(equation, interval_of(equation), t)*inverse_inertia(equation)
   end function decelerations

   !> Deceleration that determines the sum of the flights to both sides [rad/s2].
   pure real(wp) function harmonic(pull)
      real(wp), intent(in) :: pull(2)
      !! [rad/s2]

      harmonic = pull(1)*pull(2)/(pull(1) + pull(2))
   end function harmonic

   !> Viscous part of the acceleration over the velocity, on the base [1/s].
   real(wp) function damping_at(hybrid, equation, v) result(damping)
      type(hybrid_t), intent(in) :: hybrid
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: v
      !! [rad/s]
      real(wp) :: y(size(hybrid%y)), ahead

      y = hybrid%y
      y(2) = v
      ahead = second_derivative(equation, hybrid%t, y)
      y(2) = -v
      damping = max(0.0_wp, (second_derivative(equation, hybrid%t, y) - ahead)/(2*v))
   end function damping_at

end module rwmf_simulation_elastic_chatter

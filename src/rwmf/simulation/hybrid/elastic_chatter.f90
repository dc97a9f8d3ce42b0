!> Averaged treatment of nearly elastic chatter below the resolution.
!>
!> With e near 1, impacts do not bring a wall to rest that the loads press onto its base. Only
!> viscous damping shortens the flights, and millions of them may precede the next lift-off. Let v
!> be the velocity at impact, and a_1, a_2 the decelerations of flights to either side. While the
!> decelerations change slowly, the action v**3 (1/a_1 + 1/a_2) is an adiabatic invariant. Viscous
!> damping d reduces v at the relative rate d/3, because the mean of v**2 over a parabola is a third
!> of its largest value.
module rwmf_simulation_hybrid_elastic_chatter
   use rwmf_core_kinds, only: i8, wp
   use rwmf_model_lanes, only: of_input, of_viscous, power_count
   use rwmf_model_restitution, only: factor_at
   use rwmf_model_system_assembly, only: equation_t, interval_of, second_derivative
   use rwmf_model_system_energy, only: impact_loss
   use rwmf_model_system_lift_off, only: demand_turns
   use rwmf_model_system_rest_after_chatter, only: decelerations
   use rwmf_simulation_recorder_energy_balance, only: add_work
   use rwmf_simulation_recorder_recorder, only: observe_chatter, observe_rest, recorder_t
   use rwmf_simulation_state_hybrid_state, only: hybrid_t, mode_rocking
   implicit none
   private

   public :: skip_chatter, drop_chatter

   real(wp), parameter :: least_flights = 64
   !! smallest number of flights for which a jump saves work
   real(wp), parameter :: slow = 0.01_wp
   !! largest relative change of a deceleration within a flight [-]
   real(wp), parameter :: most_lost = 0.1_wp
   !! largest relative loss of velocity by impacts within a jump [-]

contains

   !> Replace bounces below the resolution by one jump within a monotone piece of the motion.
   subroutine skip_chatter(hybrid, equation, recorder, small_angle, t_limit)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: small_angle
      !! rotation below which bounces are negligible [rad]
      real(wp), intent(in) :: t_limit
      !! end of the current interval, or of the advance [s]
      real(wp) :: begin(2), pull(2)
      !! decelerations on both sides at the start and at the end of the jump [rad/s2]
      real(wp) :: v, v_end, e, damping, span, flights, ahead, y(size(hybrid%y))
      real(wp) :: gain(3)
      !! logarithmic change of the energy by ground motion, damping and impacts [-]

      v = abs(hybrid%y(2))
      if (hybrid%mode /= mode_rocking .or. abs(hybrid%y(1)) > 0 .or. v <= 0) return
      if (equation%moves_at_rest) return
      e = factor_at(hybrid%restitution, v)
      ! a jump has at least half of these flights
      if (least_flights/2*(1 - e) > most_lost) return
      begin = decelerations(equation, hybrid%t)
      if (minval(begin) <= 0) return
      if (v**2 > 2*minval(begin)*small_angle) return
      span = min(t_limit, demand_turns(equation, interval_of(equation), hybrid%t)) - hybrid%t
      if (span < least_flights*2*v/minval(begin)) return
      ! ratio of viscous acceleration to velocity at theta = 0
      y = hybrid%y
      y(2) = v
      ahead = second_derivative(equation, hybrid%t, y)
      y(2) = -v
      damping = max(0.0_wp, (second_derivative(equation, hybrid%t, y) - ahead)/(2*v))
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

   !> Add the bounces that the rest beside moving floors omits to energy balance and warnings.
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

   !> Update state, energy balance and counts for the bounces of a jump.
   subroutine note_jump(hybrid, equation, recorder, span, flights, gain)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(inout) :: recorder
      real(wp), intent(in) :: span
      !! [s]
      real(wp), intent(in) :: flights
      !! number of flights
      real(wp), intent(in) :: gain(3)
      real(wp) :: work(power_count), rest(size(hybrid%y)), total, share

      rest = hybrid%y
      rest(:2) = 0
      call observe_rest(recorder, equation, rest, hybrid%t, hybrid%t + span)
      call observe_chatter(recorder, hybrid%t, int(flights, i8))
      total = sum(gain)
      share = impact_loss(equation, hybrid%y(2), 0.0_wp)
      ! use a series for (exp(x) - 1)/x where the difference would cancel
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

   !> Equivalent deceleration for the total duration of the flights to both sides [rad/s2].
   pure real(wp) function harmonic(pull)
      real(wp), intent(in) :: pull(2)
      !! [rad/s2]

      harmonic = pull(1)*pull(2)/(pull(1) + pull(2))
   end function harmonic

end module rwmf_simulation_hybrid_elastic_chatter

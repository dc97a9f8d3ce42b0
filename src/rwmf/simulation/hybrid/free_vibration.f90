!> Closed-form free vibration of a bare linear frame after the motion, used as soon as no recorded
!> maximum can grow any more.
module rwmf_simulation_hybrid_free_vibration
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_scene, only: frame_term
   use rwmf_model_system_assembly, only: equation_t, interval_of
   use rwmf_motion_ground_motion, only: interval_last, is_known_until
   use rwmf_simulation_recorder_recorder, only: recorder_t, sees_forces
   use rwmf_simulation_state_hybrid_state, only: hybrid_t
   implicit none
   private

   public :: follow_free_vibration, long_rest

   real(wp), parameter :: long_rest = 1000
   !! shortest remaining time for which the closed form saves work [s]

contains

   !> Advance to t_target in closed form if the maxima are final; otherwise check again after two
   !> periods.
   pure subroutine follow_free_vibration(hybrid, equation, recorder, t_target, t_limit)
      type(hybrid_t), intent(inout) :: hybrid
      type(equation_t), intent(in) :: equation
      type(recorder_t), intent(in) :: recorder
      real(wp), intent(in) :: t_target
      !! [s]
      real(wp), intent(inout) :: t_limit
      !! limit of the next step [s]
      real(wp), parameter :: died_out = 1.0e-18_wp
      !! relative displacement below which forces and energies are negligible, too [-]
      real(wp) :: share

      if (t_target - hybrid%t <= long_rest .or. .not. is_free(equation, hybrid)) return
      if (recorder%keeps_history .or. .not. is_known_until(equation%motion, &
         interval_of(equation), t_target)) return
      ! a growth of the energy is an integration error
      share = 1 + hybrid%rtol
      if (recorder%keeps_energy .or. sees_forces(recorder)) share = died_out
      associate (omega => equation%p%omega_s)
         if (hybrid%y(1)**2 + (hybrid%y(2)/omega)**2 <= (share*recorder%u_max)**2) then
            hybrid%y(:2) = vibrated(equation, hybrid%y(:2), t_target - hybrid%t)
            hybrid%t = t_target
         end if
         t_limit = min(t_limit, max(hybrid%t, min(t_target, hybrid%t + 4*pi/omega)))
      end associate
   end subroutine follow_free_vibration

   !> Return whether the scene is only a linear frame whose ground motion has ended.
   pure logical function is_free(equation, hybrid)
      type(equation_t), intent(in) :: equation
      type(hybrid_t), intent(in) :: hybrid

      is_free = equation%n == 2 .and. equation%has_frame .and. .not. (equation%has_wall &
         .or. equation%has_bilinear_springs .or. equation%has_loading_direction) &
         .and. hybrid%drifts == 0 .and. interval_of(equation) >= interval_last(equation%motion)
      if (is_free) is_free = all(equation%scene%terms%effect == frame_term)
   end function is_free

   !> Displacement [m] and velocity [m/s] after a free vibration.
   pure function vibrated(equation, y, span) result(y_end)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(2)
      !! [m], [m/s]
      real(wp), intent(in) :: span
      !! [s]
      real(wp) :: y_end(2)
      complex(wp) :: root(2), part(2)

      associate (omega => equation%p%omega_s, xi => equation%p%xi_s)
         ! roots of the characteristic equation, kept apart near critical damping
         root(1) = sqrt(cmplx(xi**2 - 1, 0.0_wp, wp))
         if (abs(root(1)) < 1.0e-6_wp) root(1) = 1.0e-6_wp
         root = omega*(-xi + [root(1), -root(1)])
      end associate
      part = [y(2) - root(2)*y(1), root(1)*y(1) - y(2)]/(root(1) - root(2))*exp(root*span)
      y_end = [real(sum(part), wp), real(sum(part*root), wp)]
   end function vibrated

end module rwmf_simulation_hybrid_free_vibration

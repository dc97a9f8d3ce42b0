!> What a wall that stands on its base bears before it lifts off, when further effects act there.
module rwmf_model_uplift
   use rwmf_core_kinds, only: wp
   use rwmf_model_cable, only: cable_state_t
   use rwmf_model_equation, only: cable_at, equation_t, kinematics_at
   use rwmf_model_kinematics, only: kinematics_t
   implicit none
   private

   public :: find_uplift_acceleration

contains

   !> Ground acceleration at which the resting wall lifts off on either side, and the inertia that
   !> further effects add there: from the moment about the pivot at theta = 0 without ground motion.
   !>
   !> Scenes without further effects keep the closed form of `build_equation`.
   subroutine find_uplift_acceleration(equation, y)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: y(:)
      !! (states); the first two are taken as zero
      type(kinematics_t) :: kin
      type(cable_state_t) :: cable
      real(wp) :: at_rest(size(y))
      real(wp) :: rates(size(y))
      !! of further states, not asked for here
      real(wp) :: moment
      integer :: side_in_force
      integer :: side
      integer :: i

      if (.not. equation%effects_act_at_rest) return
      at_rest = y
      at_rest(:2) = 0
      side_in_force = equation%side
      do side = -1, 1, 2
         equation%side = side
         kin = kinematics_at(equation, 0.0_wp)
         cable = cable_at(equation, 0.0_wp)
         moment = -equation%p%g_over_R*(kin%s + cable%moment)
         equation%added_inertia = 0
         if (allocated(equation%effects)) then
            do i = 1, size(equation%effects)
               if (equation%effects(i)%is_motion) cycle
               call equation%effects(i)%add(equation, 0.0_wp, at_rest, kin, &
                  equation%added_inertia, moment, rates)
            end do
         end if
         equation%uplift_acceleration(side) = &
            -moment*equation%p%R/(equation%p%gamma*equation%excited_mass_ratio*kin%lever &
            + kin%c)
      end do
      equation%side = side_in_force
   end subroutine find_uplift_acceleration

end module rwmf_model_uplift

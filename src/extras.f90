!> Effects beyond wall, frame and cable: which of them a case calls for, and what they have in
!> common. One line in `choose_extras` for each.
module rwmf_extras
   use rwmf_case, only: case_t
   use rwmf_damper, only: add_damper, damper_force, damper_power
   use rwmf_kinds, only: wp
   use rwmf_memory, only: add_springs, choose_springs, springs_energy, springs_force, &
      springs_power
   use rwmf_scene, only: equation_t, extra_t
   implicit none
   private

   public :: choose_extras, rates_of_all, extra_sizes, extra_energy, extra_power

contains

   !> Put the further effects of a case on the list. Scenes without any have no list.
   subroutine choose_extras(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation

      if (allocated(case%damper)) then
         equation%damper_c = case%damper%c_over_m_w
         call add_extra(equation, extra_t(add=add_damper, power=damper_power, &
            force=damper_force))
      end if
      if (allocated(case%fuse) .or. allocated(case%yielding) .or. equation%cable%is_tendon) then
         call choose_springs(case, equation)
      end if
      if (allocated(case%fuse) .or. allocated(case%yielding)) then
         call add_extra(equation, extra_t(add=add_springs, power=springs_power, &
            energy=springs_energy, force=springs_force, is_hysteretic=.true.))
      end if
   end subroutine choose_extras

   !> Append an effect; its states come after those that are there.
   subroutine add_extra(equation, extra)
      type(equation_t), intent(inout) :: equation
      type(extra_t), intent(in) :: extra

      if (.not. allocated(equation%extras)) allocate (equation%extras(0))
      equation%extras = [equation%extras, extra]
      equation%extras(size(equation%extras))%first = equation%n + 1
      equation%n = equation%n + extra%states
   end subroutine add_extra

   !> Right-hand side of scenes with further states, without counting. Not a part of `rhs`, which
   !> would then pay for this call in all other scenes.
   subroutine rates_of_all(equation, t, y, y_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(equation%n)
      !! (states)
      real(wp), intent(out) :: y_dot(equation%n)
      !! (states)
      integer :: i

      y_dot(1) = y(2)
      if (equation%side > 0) then
         y_dot(2) = equation%acceleration_positive(equation, t, y)
      else
         y_dot(2) = equation%acceleration_negative(equation, t, y)
      end if
      do i = 1, size(equation%extras)
         associate (extra => equation%extras(i))
            if (extra%states == 0) cycle
            call extra%rates(equation, t, y, y_dot(extra%first:extra%first + extra%states - 1))
         end associate
      end do
   end subroutine rates_of_all

   !> Expected sizes of all states from those of the first two, for absolute tolerances.
   function extra_sizes(equation, size_guess) result(sizes)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! of theta and theta' [rad], [rad/s] or of u and u' [m], [m/s]
      real(wp) :: sizes(equation%n)
      integer :: i

      sizes(:2) = size_guess
      if (equation%n == 2) return
      do i = 1, size(equation%extras)
         associate (extra => equation%extras(i))
            if (extra%states == 0) cycle
            call extra%sizes(equation, size_guess, &
               sizes(extra%first:extra%first + extra%states - 1))
         end associate
      end do
   end function extra_sizes

   !> Energy that further effects store [J/kg].
   real(wp) function extra_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      integer :: i

      energy = 0
      if (.not. allocated(equation%extras)) return
      do i = 1, size(equation%extras)
         if (associated(equation%extras(i)%energy)) then
            energy = energy + equation%extras(i)%energy(equation, y)
         end if
      end do
   end function extra_energy

   !> Power that further effects dissipate [W/kg].
   real(wp) function extra_power(equation, t, y, is_hysteretic) result(power)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      logical, intent(in) :: is_hysteretic
      !! by yielding, or else by the others
      integer :: i

      power = 0
      if (.not. allocated(equation%extras)) return
      do i = 1, size(equation%extras)
         if (equation%extras(i)%is_hysteretic .neqv. is_hysteretic) cycle
         if (associated(equation%extras(i)%power)) then
            power = power + equation%extras(i)%power(equation, t, y)
         end if
      end do
   end function extra_power

end module rwmf_extras

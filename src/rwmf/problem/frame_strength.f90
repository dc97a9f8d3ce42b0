!> Strength and hysteresis law of the frame of a case that yields, as a whole or storey by storey.
module rwmf_problem_frame_strength
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_case, only: case_t, has_floors, spring_law_t
   implicit none
   private

   public :: has_strength, storeys_have_strengths, has_branches, frame_law, frame_hardening
   public :: yield_displacement, first_yield, storey_strengths, count_linked_smooth

contains

   !> True if the frame has a strength, so that it yields.
   pure logical function has_strength(case)
      type(case_t), intent(in) :: case

      has_strength = allocated(case%yielding)
   end function has_strength

   !> True if each storey has its own strength.
   pure logical function storeys_have_strengths(case)
      type(case_t), intent(in) :: case

      storeys_have_strengths = allocated(case%yielding)
      if (storeys_have_strengths) storeys_have_strengths = allocated(case%yielding%storey_u_y)
   end function storeys_have_strengths

   !> True if the hysteresis of a frame with strength consists of branches; false for a smooth law.
   pure logical function has_branches(case)
      type(case_t), intent(in) :: case

      has_branches = case%yielding%law%name /= 'bouc_wen'
   end function has_branches

   !> Hysteresis law of a frame with strength.
   pure type(spring_law_t) function frame_law(case)
      type(case_t), intent(in) :: case

      frame_law = case%yielding%law
   end function frame_law

   !> Stiffness of a frame with strength after yielding over its elastic stiffness [-].
   pure real(wp) function frame_hardening(case)
      type(case_t), intent(in) :: case

      frame_hardening = case%yielding%hardening
   end function frame_hardening

   !> Displacement of a frame with strength at first yield [m].
   pure real(wp) function yield_displacement(case) result(u_y)
      type(case_t), intent(in) :: case
      !! case with the frame's T_s

      if (allocated(case%yielding%u_y)) then
         u_y = case%yielding%u_y
      else
         u_y = case%yielding%f_y_over_m_s_g*case%model%g*(case%frame%T_s/(2*pi))**2
      end if
   end function yield_displacement

   !> Displacements of n storeys at first yield [m].
   pure function first_yield(case, n) result(u_y)
      type(case_t), intent(in) :: case
      !! case whose frame has strength
      integer, intent(in) :: n
      !! number of storeys
      real(wp) :: u_y(n)

      if (storeys_have_strengths(case)) then
         u_y = storey_strengths(case)
      else
         u_y = yield_displacement(case)
      end if
   end function first_yield

   !> Displacement of each storey at first yield [m].
   pure function storey_strengths(case) result(u_y)
      type(case_t), intent(in) :: case
      !! case whose storeys have strengths
      real(wp) :: u_y(size(case%frame%floors%m))

      if (allocated(case%yielding%f_y_over_m_s_g)) then
         ! the storeys of a frame beside a wall that bends, with equal drifts
         associate (height => case%frame%floors%height)
            u_y = yield_displacement(case)*(height/sum(height))
         end associate
      else if (size(case%yielding%storey_u_y) == 1) then
         u_y = case%yielding%storey_u_y(1)
      else
         u_y = case%yielding%storey_u_y
      end if
   end function storey_strengths

   !> Number of storeys with a smooth law whose floors are linked to a wall one by one.
   pure integer function count_linked_smooth(case) result(n)
      type(case_t), intent(in) :: case

      n = 0
      if (.not. (has_floors(case) .and. has_strength(case))) return
      if (case%frame%coupling /= 'every_floor' .or. has_branches(case)) return
      n = size(case%frame%floors%m)
   end function count_linked_smooth

end module rwmf_problem_frame_strength

!> What bench/effects.py counts instructions of.
!>
!>    effects kernel NAME CASE.nml N    N right-hand sides of the kernel
!>    effects hand NAME CASE.nml N      N of the program written by hand for the scene NAME
!>
!> Both go through the same states, on both sides, in one interval of the ground motion, and print
!> the sum of theta'', by which they are compared.
program effects
   use effects_by_hand, only: choose, hand_i, hand_t, prepare
   use rwmf, only: case_t, error_t, read_case_file, wp
   use rwmf_equation, only: build_equation, enter_interval, equation_t, rhs
   use rwmf_motion, only: acceleration, interval_at, motion_from_case, motion_t
   implicit none

   integer, parameter :: n_states = 64
   real(wp), parameter :: t_begin = 2.025_wp
   !! between two samples of the record [s]

   !> States to evaluate at.
   type :: table_t
      real(wp) :: t(n_states)
      real(wp) :: y(2, n_states)
      integer :: side(n_states)
   end type table_t

   type(case_t) :: case
   type(motion_t), target :: motion
   type(table_t) :: table
   character(4096) :: argument(4)
   integer :: rounds
   integer :: i

   do i = 1, 4
      call get_command_argument(i, argument(i))
   end do
   read (argument(4), *) rounds
   rounds = rounds/n_states
   call read_case(trim(argument(3)), case)
   motion = motion_from_case(case)
   call fill(case, table)
   if (argument(1) == 'kernel') then
      print '(es22.14)', sum_of_kernel()
   else
      print '(es22.14)', sum_of_hand(trim(argument(2)))
   end if

contains

   subroutine read_case(path, case)
      character(*), intent(in) :: path
      type(case_t), intent(out) :: case
      type(error_t), allocatable :: error

      call read_case_file(path, case, error)
      if (.not. allocated(error)) return
      print '(a)', error%message
      error stop 2
   end subroutine read_case

   !> Rotations up to 0.9 alpha (bare frame: displacements in m) and velocities of both signs, on
   !> both sides, within one interval of the motion.
   subroutine fill(case, table)
      type(case_t), intent(in) :: case
      type(table_t), intent(out) :: table
      real(wp) :: alpha
      integer :: i

      alpha = 1
      if (allocated(case%wall)) alpha = atan2(case%wall%b, case%wall%h)
      do i = 1, n_states
         table%side(i) = merge(1, -1, mod(i, 2) == 1)
         table%t(i) = t_begin + 0.01_wp*i/n_states
         if (.not. allocated(case%record)) table%t(i) = (i - 0.5_wp)/n_states
         table%y(1, i) = table%side(i)*0.9_wp*alpha*mod(7*i, n_states)/n_states
         table%y(2, i) = sin(1.0_wp*i)
      end do
   end subroutine fill

   !> theta'' summed over all evaluations.
   real(wp) function sum_of_kernel() result(total)
      type(equation_t) :: equation
      real(wp) :: y_dot(2)
      logical :: rocks
      integer :: i
      integer :: j

      call build_equation(case, motion, equation)
      call enter_interval(equation, interval_at(motion, table%t(1)))
      rocks = equation%has_impacts
      total = 0
      do i = 1, rounds
         do j = 1, n_states
            if (rocks) equation%side = table%side(j)
            call rhs(equation, table%t(j), table%y(:, j), y_dot)
            total = total + y_dot(2)
         end do
      end do
   end function sum_of_kernel

   real(wp) function sum_of_hand(name) result(total)
      character(*), intent(in) :: name
      procedure(hand_i), pointer :: right_hand_side
      type(hand_t) :: p
      real(wp) :: y_dot(2)
      logical :: rocks
      integer :: i
      integer :: j

      call choose(name, right_hand_side)
      if (.not. associated(right_hand_side)) error stop 'no program of that name'
      call prepare(case, p)
      call follow_record(p)
      rocks = allocated(case%wall)
      if (rocks) rocks = case%wall%base == 'rocking'
      p%side = 1
      y_dot = 0
      total = 0
      do i = 1, rounds
         do j = 1, n_states
            if (rocks) p%side = table%side(j)
            call right_hand_side(p, table%t(j), table%y(:, j), y_dot)
            total = total + y_dot(2)
         end do
      end do
   end function sum_of_hand

   !> Straight line between the samples around the times of the table.
   subroutine follow_record(p)
      type(hand_t), intent(inout) :: p
      integer :: k

      if (.not. allocated(case%record)) return
      k = interval_at(motion, table%t(1))
      p%t_k = case%record%t(k)
      p%a_k = acceleration(motion, k, p%t_k)
      p%slope = (case%record%a(k + 1) - case%record%a(k)) &
         /(case%record%t(k + 1) - case%record%t(k))
   end subroutine follow_record

end program effects

!> What bench/effects.py counts instructions of.
!>
!>    effects NAME CASE.nml [NAME CASE.nml ...]
!>
!> For each scene the right-hand sides of the program written by hand for the scene NAME, those of
!> the kernel, and a run of the kernel, between calls of `mark`. The right-hand sides go through the
!> same states, on both sides, in one interval of the ground motion. Prints the number of states,
!> the sums of all rates but theta' of both, by which they are compared, and the number of steps of
!> the run.
program effects
   use effects_by_hand, only: choose, follow_by_hand => follow_loading_direction, hand_i, hand_t, &
      mark, prepare
   use rwmf, only: case_t, error_t, read_case_file, result_t, simulate, wp
   use rwmf_model_assembly, only: build_equation, enter_interval, enter_side, equation_t, rhs
   use rwmf_model_hysteresis_bouc_wen, only: follow_loading_direction
   use rwmf_model_hysteresis_spring_set, only: pass_window, renew_window
   use rwmf_motion_ground_motion, only: acceleration, interval_at, motion_from_case, motion_t
   implicit none

   integer, parameter :: n_states = 64
   real(wp), parameter :: t_begin = 2.025_wp
   !! between two samples of the record [s]

   !> States to evaluate at.
   type :: table_t
      real(wp) :: t(n_states)
      real(wp), allocatable :: y(:, :)
      !! (as many as the equation has, n_states)
      integer :: side(n_states)
      integer :: loading_direction(n_states)
      !! sign of theta'
   end type table_t

   character(4096) :: name
   character(4096) :: path
   integer :: i

   do i = 1, command_argument_count(), 2
      call get_command_argument(i, name)
      call get_command_argument(i + 1, path)
      call count_scene(trim(name), trim(path))
   end do

contains

   !> Four sections of counts: what came before, hand, kernel, run.
   subroutine count_scene(name, path)
      character(*), intent(in) :: name
      character(*), intent(in) :: path
      type(case_t) :: case
      type(motion_t), target :: motion
      type(table_t) :: table
      type(equation_t) :: equations(n_states)
      !! of each state: what yields does so in the direction of its side
      type(hand_t) :: p
      type(result_t) :: result
      type(error_t), allocatable :: error
      procedure(hand_i), pointer :: by_hand
      real(wp) :: total
      real(wp) :: total_hand
      integer :: j

      call read_case(path, case)
      motion = motion_from_case(case)
      call fill_times(case, table)
      call build_equation(case, motion, equations(1))
      call fill_states(case, equations(1)%n, table)
      do j = 1, n_states
         call prepare_state(case, motion, table, index(name, '_yielding') > 0, j, equations(j))
      end do
      call prepare(case, p)
      p%n = equations(1)%n
      call follow_record(case, motion, table%t(1), p)
      call choose(name, by_hand)
      if (.not. associated(by_hand)) error stop 'no program of that name'
      ! once before anything is counted: the first call of sin is bound then
      total = sum_of_hand(by_hand, p, table, equations(1)%has_impacts)
      total = sum_of_kernel(equations, table)
      call mark()
      total_hand = sum_of_hand(by_hand, p, table, equations(1)%has_impacts)
      call mark()
      total = sum_of_kernel(equations, table)
      call mark()
      call simulate(case, result, error)
      call mark()
      if (allocated(error)) error stop 'the run failed'
      print '(i0, 2es24.15, 1x, i0)', n_states, total_hand, total, result%steps
   end subroutine count_scene

   subroutine read_case(path, case)
      character(*), intent(in) :: path
      type(case_t), intent(out) :: case
      type(error_t), allocatable :: error

      call read_case_file(path, case, error)
      if (.not. allocated(error)) return
      print '(a)', error%message
      error stop 2
   end subroutine read_case

   !> Equation at one state, before anything yields or after it has begun to.
   subroutine prepare_state(case, motion, table, yields, j, equation)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in), target :: motion
      type(table_t), intent(in) :: table
      logical, intent(in) :: yields
      integer, intent(in) :: j
      !! number of the state
      type(equation_t), intent(out) :: equation

      call build_equation(case, motion, equation)
      call enter_interval(equation%model_t, equation%state, interval_at(motion, table%t(1)))
      if (equation%has_impacts) call enter_side(equation%model_t, equation%state, table%side(j))
      equation%state%signs%loading_direction = table%loading_direction(j)
      if (equation%has_loading_direction) call follow_loading_direction(equation%model_t, &
         equation%state, table%y(:, j))
      if (.not. yields) return
      ! the first limit on the way out is the first yield
      call renew_window(equation%model_t, equation%state)
      call pass_window(equation%model_t, equation%state, is_rising=equation%state%side > 0)
   end subroutine prepare_state

   !> Times within one interval of the motion.
   subroutine fill_times(case, table)
      type(case_t), intent(in) :: case
      type(table_t), intent(inout) :: table
      integer :: j

      do j = 1, n_states
         table%t(j) = t_begin + 0.01_wp*j/n_states
         if (.not. allocated(case%record)) table%t(j) = (j - 0.5_wp)/n_states
      end do
   end subroutine fill_times

   !> Rotations up to 0.9 alpha (bare frame: displacements in m) on both sides, velocities of both
   !> signs, and further states up to 0.9.
   subroutine fill_states(case, n, table)
      type(case_t), intent(in) :: case
      integer, intent(in) :: n
      !! number of states of the equation
      type(table_t), intent(inout) :: table
      real(wp) :: alpha
      integer :: i, j

      alpha = 1
      if (allocated(case%wall)) alpha = atan2(case%wall%b, case%wall%h)
      allocate (table%y(n, n_states))
      do j = 1, n_states
         table%side(j) = merge(1, -1, mod(j, 2) == 1)
         table%y(1, j) = table%side(j)*0.9_wp*alpha*mod(7*j, n_states)/n_states
         table%y(2, j) = sin(1.0_wp*j)
         table%loading_direction(j) = merge(1, -1, table%y(2, j) > 0)
         do i = 3, n
            table%y(i, j) = 0.9_wp*sin(1.7_wp*i*j)
         end do
      end do
   end subroutine fill_states

   !> Straight line between the samples around a time.
   subroutine follow_record(case, motion, t, p)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      real(wp), intent(in) :: t
      !! [s]
      type(hand_t), intent(inout) :: p
      integer :: k

      p%side = 1
      if (.not. allocated(case%record)) return
      k = interval_at(motion, t)
      p%t_k = case%record%t(k)
      p%a_k = acceleration(motion, k, p%t_k)
      p%slope = case%record%factor*(case%record%a(k + 1) - case%record%a(k)) &
         /(case%record%t(k + 1) - case%record%t(k))
   end subroutine follow_record

   !> All rates but theta' of the kernel, summed over all states.
   real(wp) function sum_of_kernel(equations, table) result(total)
      type(equation_t), intent(inout) :: equations(n_states)
      type(table_t), intent(in) :: table
      real(wp) :: y_dot(size(table%y, 1))
      integer :: j

      total = 0
      do j = 1, n_states
         call rhs(equations(j), table%t(j), table%y(:, j), y_dot)
         total = total + sum(y_dot(2:))
      end do
   end function sum_of_kernel

   !> The same of the program by hand.
   real(wp) function sum_of_hand(by_hand, p, table, rocks) result(total)
      procedure(hand_i), pointer, intent(in) :: by_hand
      type(hand_t), intent(inout) :: p
      type(table_t), intent(in) :: table
      logical, intent(in) :: rocks
      real(wp) :: y_dot(size(table%y, 1))
      integer :: j

      total = 0
      do j = 1, n_states
         if (rocks) p%side = table%side(j)
         if (p%n > 2) call follow_by_hand(table%loading_direction(j), table%y(3, j), p)
         call by_hand(p, table%t(j), table%y(:, j), y_dot)
         total = total + sum(y_dot(2:))
      end do
   end function sum_of_hand

end program effects

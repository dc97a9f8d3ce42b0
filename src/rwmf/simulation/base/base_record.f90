!> Outputs of a wall on a base that gives: extremes, energies and history, from the series of each
!> step.
!>
!> Every output is a column: a series of the step. A row of the history evaluates it; an extreme is
!> searched where the terms of the series allow a new record.
module rwmf_simulation_base_base_record
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_polynomial_roots, only: find_largest
   use rwmf_math_power_series, only: product_term, series_value
   use rwmf_model_base_base_regime, only: base_regime_t
   use rwmf_model_base_base_scene, only: base_scene_t, elongations
   use rwmf_model_base_base_series, only: base_series_t, is_crushing, is_pressed
   use rwmf_model_hysteresis_spring_laws, only: spring_energy
   use rwmf_model_series_series_motion, only: highest_order
   use rwmf_problem_case, only: case_t, seeks
   use rwmf_problem_quantity_table, only: id
   use rwmf_problem_quantity_values, only: clear, put, values_t
   use rwmf_simulation_state_history, only: create_history, history_t
   use rwmf_simulation_state_result, only: energy_t
   use rwmf_text_decimal, only: short_decimal
   implicit none
   private

   public :: base_record_t, create_record, find_columns, observe_step, stored_t, stored_energies
   public :: of_u, of_theta, of_rate, of_middle, of_left, of_right, of_normal, of_shear
   public :: of_contact, of_slip, of_tendon, of_stress, of_total, of_drift, first_floor
   public :: first_spring

   integer, parameter :: of_u = 1, of_theta = 2, of_rate = 3
   !! u_s [m], theta [rad], theta' [rad/s]
   integer, parameter :: of_middle = 4, of_left = 5, of_right = 6
   !! height of the middle, settlement of both edges [m]
   integer, parameter :: of_normal = 7, of_shear = 8
   !! forces of the base over m_w g [-]
   integer, parameter :: of_contact = 9, of_slip = 10
   !! contact length, slip [m]
   integer, parameter :: of_tendon = 11
   !! force over m_w g [-]
   integer, parameter :: of_stress = 12
   !! stress at the left end of the contact over k [m]; the next: at the right end
   integer, parameter :: of_u_rate = 14, of_turn = 15, of_ground = 16, of_upward = 17
   !! u_s' [m/s], theta'' [rad/s2], accelerations of the ground [m/s2]
   integer, parameter :: of_total = 18, of_drift = 19
   !! base shear of wall and frame over their weight [-], displacement of the wall's top over its
   !! height [-]
   integer, parameter :: first_floor = 20
   !! drifts [-] of all storeys, then accelerations of all floors over g [-]; elongations [m] and
   !! forces over the weight of wall or frame [-] of all springs follow, from `first_spring`

   !> Columns with their extremes so far, energies and history.
   type :: base_record_t
      real(wp), allocatable :: series(:, :)
      !! (0:highest_order, columns) coefficients of each, in its unit
      logical, allocatable :: is_sought(:)
      !! (columns) their extremes are requested
      real(wp), allocatable :: extremes(:, :), times(:, :)
      !! (2, columns) smallest and largest value, and their times [s]
      real(wp) :: stress = 0
      !! largest stress of strips over k [m]
      real(wp), allocatable :: travel(:)
      !! (springs) sum of all strokes there and back [m]
      logical :: keeps_energy = .false.
      type(energy_t) :: energy
      real(wp) :: base_start = 0
      !! stored in the base at the start [J/kg]
      real(wp) :: base_work = 0
      !! of the wall on its base [J/kg]
      real(wp) :: friction = 0
      !! dissipated by slip [J/kg]
      type(history_t), allocatable :: history
      type(values_t) :: row
      !! columns of the history at one instant
      logical :: has_offsets = .false.
      !! the case gives the places of the fuses
      logical :: has_vertical = .false.
      !! that of the vertical motion is among them
      real(wp) :: m_w_g = 0
      !! weight of the wall, 0 if the case gives no mass [N]
      integer :: rows = 0
      !! of the history, written so far
      real(wp) :: dt = 0
      !! interval of the history [s]
   end type base_record_t

   !> Energies of a state, all but that of the base zero for the wall at rest [J/kg].
   type :: stored_t
      real(wp) :: kinetic = 0
      real(wp) :: strain = 0
      !! of the frame
      real(wp) :: gravity = 0
      real(wp) :: cable = 0
      real(wp) :: fuses = 0
      real(wp) :: base = 0
   end type stored_t

contains

   !> First column of the springs.
   pure integer function first_spring(scene)
      type(base_scene_t), intent(in) :: scene

      first_spring = first_floor + 2*scene%frame%n
   end function first_spring

   !> Allocate the columns that a case requests.
   subroutine create_record(case, scene, regime, y, record, error)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: y(:)
      !! (states) at the start
      type(base_record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      !! the history does not fit into memory
      type(stored_t) :: stored
      logical :: has_shear
      integer :: n

      has_shear = .true.
      n = first_spring(scene) - 1 + 2*size(scene%springs)
      allocate (record%series(0:highest_order, n), source=0.0_wp)
      allocate (record%is_sought(n), source=.false.)
      allocate (record%extremes(2, n), record%times(2, n), source=0.0_wp)
      record%extremes(1, :) = huge(1.0_wp)
      record%extremes(2, :) = -huge(1.0_wp)
      allocate (record%travel(size(scene%springs)), source=0.0_wp)
      record%is_sought(:of_rate) = .true.
      if (.not. allocated(case%output)) return
      associate (output => case%output, sought => record%is_sought)
         sought(of_middle) = seeks(output, [id%middle_rise_max_m])
         sought(of_left:of_right) = seeks(output, [id%toe_settlement_max_m])
         sought(of_normal) = seeks(output, [id%base_normal_max_over_m_w_g, &
            id%base_normal_min_over_m_w_g])
         sought(of_shear) = seeks(output, [id%base_shear_max_over_m_w_g])
         sought(of_contact) = seeks(output, [id%contact_length_min_m])
         sought(of_slip) = scene%slides .and. seeks(output, [id%slide_max_m])
         sought(of_tendon) = scene%has_tendon .and. seeks(output, &
            [id%cable_force_increment_max_over_m_w_g, id%tendon_force_max_over_m_w_g])
         sought(of_stress:of_stress + 1) = seeks(output, [id%toe_stress_max_over_k_m, &
            id%toe_stress_max_Pa])
         ! one mode of storeys has not the shear of all floors
         if (allocated(scene%frame%height)) has_shear = size(scene%frame%height) == scene%frame%n
         sought(of_total) = output%reactions .and. has_shear .and. seeks(output, &
            [id%base_shear_max_over_weight, id%t_base_shear_max_s])
         sought(of_drift) = output%reactions .and. seeks(output, [id%wall_drift_max])
         sought(first_floor:first_spring(scene) - 1) = output%demands
         sought(first_spring(scene):) = output%envelopes
         record%keeps_energy = output%energy
         stored = stored_energies(scene, regime, y)
         record%base_start = stored%base
         record%energy = energy_t(stored%kinetic + stored%strain + stored%gravity + stored%cable &
            + stored%fuses + stored%base, 0, 0, 0, 0, 0)
         if (.not. allocated(output%dt)) return
         record%dt = output%dt
         call create_columns(case, scene, record)
         allocate (record%history)
         call create_history(record%history, record%row, case%solver%t_end, record%dt, error)
      end associate
   end subroutine create_record

   !> Set up the columns of the history.
   pure subroutine create_columns(case, scene, record)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(base_record_t), intent(inout) :: record

      record%has_vertical = allocated(case%upward)
      if (allocated(case%fuse)) record%has_offsets = allocated(case%fuse%offset)
      record%m_w_g = case%unit_mass*scene%g
      call put_columns(scene, record, 0.0_wp, 0.0_wp, 0)
   end subroutine create_columns

   !> Put the columns of the history at one instant into the row.
   pure subroutine put_columns(scene, record, t, x, order)
      type(base_scene_t), intent(in) :: scene
      type(base_record_t), intent(inout) :: record
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: x
      !! time since the start of the step [s]
      integer, intent(in) :: order
      !! of the series
      integer :: i, number

      associate (row => record%row, n => scene%frame%n)
         call clear(row)
         call put(row, id%t_s, t)
         call put(row, id%theta_rad, at(of_theta))
         call put(row, id%theta_dot_rad_s, at(of_rate))
         call put(row, id%theta_ddot_rad_s2, at(of_turn))
         if (n > 0) call put(row, id%u_s_m, at(of_u))
         if (n > 0) call put(row, id%u_s_dot_m_s, at(of_u_rate))
         call put(row, id%u_g_ddot_m_s2, at(of_ground))
         if (record%has_vertical) call put(row, id%v_g_ddot_m_s2, at(of_upward))
         if (scene%has_tendon) call put(row, id%cable_force_over_m_w_g, at(of_tendon))
         if (scene%has_tendon .and. record%m_w_g > 0) call put(row, id%cable_force_N, &
            at(of_tendon)*record%m_w_g)
         do i = 1, size(scene%springs)
            if (i > scene%fuses) then
               number = id%frame_force_over_m_s_g
            else if (record%has_offsets) then
               number = id%fuse_i_force_over_m_w_g
            else
               number = merge(id%fuse_left_force_over_m_w_g, id%fuse_right_force_over_m_w_g, i == 1)
            end if
            call put(row, number, [at(first_spring(scene) + size(scene%springs) + i - 1)], &
               merge(i - 1, 0, number == id%fuse_i_force_over_m_w_g))
         end do
         call put(row, id%base_height_m, at(of_middle))
         if (scene%slides) call put(row, id%base_slip_m, at(of_slip))
         call put(row, id%base_normal_over_m_w_g, at(of_normal))
         if (record%m_w_g > 0) call put(row, id%base_normal_N, at(of_normal)*record%m_w_g)
         call put(row, id%base_shear_over_m_w_g, at(of_shear))
         if (allocated(scene%frame%height)) call put(row, id%storey_i_drift, &
            [(at(first_floor + i - 1), i=1, n)])
         call put(row, id%floor_i_acceleration_g, [(at(first_floor + n + i - 1), i=1, n)])
         call put(row, id%contact_length_m, at(of_contact))
      end associate

   contains

      !> Column at the instant.
      pure real(wp) function at(column)
         integer, intent(in) :: column

         at = series_value(record%series(:order, column), x)
      end function at
   end subroutine put_columns

   !> Find the columns of a history at one instant.
   subroutine find_columns(case, scene, regime, series, t, row)
      type(case_t), intent(in) :: case
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_series_t), intent(in) :: series
      !! of the instant
      real(wp), intent(in) :: t
      !! [s]
      type(values_t), intent(out) :: row
      type(base_record_t) :: record

      allocate (record%series(0:highest_order, first_spring(scene) - 1 + 2*size(scene%springs)), &
         source=0.0_wp)
      allocate (record%is_sought(0))
      call create_columns(case, scene, record)
      call fill_columns(scene, regime, series, record)
      call put_columns(scene, record, t, 0.0_wp, 0)
      row = record%row
   end subroutine find_columns

   !> Record a step.
   subroutine observe_step(scene, regime, t, h, series, record)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: t
      !! start of the step [s]
      real(wp), intent(in) :: h
      !! length of the step up to its event [s]
      type(base_series_t), intent(in) :: series
      type(base_record_t), intent(inout) :: record
      integer :: i
      real(wp) :: time

      call fill_columns(scene, regime, series, record)
      do i = 1, size(record%is_sought)
         if (record%is_sought(i)) call keep_extremes(record%series(:series%order, i), t, h, &
            record%extremes(:, i), record%times(:, i))
      end do
      if (scene%strips > 0 .and. record%is_sought(of_stress)) call observe_strips(scene, regime, &
         h, series, record%stress)
      if (any(record%is_sought(first_spring(scene):))) then
         do i = 1, size(record%travel)
            record%travel(i) = record%travel(i) &
               + path_length(series%device%stretch(:series%order, i), h)
         end do
      end if
      if (record%keeps_energy) call add_work(scene, regime, h, series, record)
      ! write the rows of the history within a step
      if (allocated(record%history)) then
         do while (record%rows < size(record%history%values, 1))
            time = short_decimal(record%rows*record%dt)
            ! the next step writes the row at its start
            if (time > t .and. time >= t + h) return
            record%rows = record%rows + 1
            call put_columns(scene, record, time, max(0.0_wp, time - t), series%order)
            record%history%values(record%rows, :) = record%row%numbers(:record%row%n)
         end do
      end if
   end subroutine observe_step

   !> Update smallest and largest value of a column.
   pure subroutine keep_extremes(c, t, h, extremes, times)
      real(wp), intent(in) :: c(0:)
      !! series of the column
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: h
      !! [s]
      real(wp), intent(inout) :: extremes(2)
      real(wp), intent(inout) :: times(2)
      !! [s]
      real(wp) :: spread, largest, place
      integer :: k

      spread = 0
      do k = ubound(c, 1), 1, -1
         spread = (spread + abs(c(k)))*h
      end do
      if (c(0) + spread > extremes(2)) then
         call find_largest(c, h, largest, place)
         if (largest > extremes(2)) then
            extremes(2) = largest
            times(2) = t + place
         end if
      end if
      if (c(0) - spread < extremes(1)) then
         call find_largest(-c, h, largest, place)
         if (-largest < extremes(1)) then
            extremes(1) = -largest
            times(1) = t + place
         end if
      end if
   end subroutine keep_extremes

   !> Length of the path of a quantity over a step, which turns at most twice.
   pure real(wp) function path_length(c, h) result(path)
      real(wp), intent(in) :: c(0:)
      !! series of the quantity
      real(wp), intent(in) :: h
      !! [s]
      real(wp) :: value(4), place(2)

      value([1, 4]) = [c(0), series_value(c, h)]
      call find_largest(c, h, value(2), place(1))
      call find_largest(-c, h, value(3), place(2))
      value(3) = -value(3)
      if (place(1) > place(2)) value(2:3) = value([3, 2])
      path = sum(abs(value(2:) - value(:3)))
   end function path_length

   !> Set the columns to the series of a step.
   pure subroutine fill_columns(scene, regime, series, record)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      type(base_series_t), intent(in) :: series
      type(base_record_t), intent(inout) :: record
      real(wp) :: weight
      !! of wall or frame over m_w [m/s2]
      integer :: i, k, n

      n = series%order
      associate (of => series, column => record%series, b => scene%b)
         column(:n, of_u) = of%x(:n) + of%u(:n)
         column(:n, of_theta) = of%theta(:n)
         column(:n, of_rate) = of%theta_dot(:n)
         if (.not. (allocated(record%history) .or. any(record%is_sought(of_rate + 1:)))) return
         column(:n, of_middle) = of%z(:n)
         column(:n, of_left) = -b*of%turn%sine(:n) - of%z(:n)
         column(:n, of_right) = b*of%turn%sine(:n) - of%z(:n)
         column(:n, of_normal) = of%normal(:n)/scene%g
         column(:n, of_shear) = of%shear(:n)/scene%g
         column(:n, of_slip) = of%x(:n)
         column(:n, of_tendon) = 0
         if (scene%has_tendon .and. regime%is_taut) column(:n, of_tendon) = of%tendon(:n)
         if (scene%strips > 0) then
            column(:n, of_contact) = 0
            column(0, of_contact) = scene%width*count(regime%strips == is_pressed &
               .or. regime%strips == is_crushing)
         else
            column(:n, of_contact) = of%contact%spans(:n, 1)
            do k = 0, n
               column(k, of_stress) = product_term(k, of%contact%a2, of%contact%ends(:, 1, 1)) &
                  - of%contact%b2(k)
               column(k, of_stress + 1) = product_term(k, of%contact%a2, of%contact%ends(:, 1, 2)) &
                  - of%contact%b2(k)
            end do
            if (.not. regime%touches) column(:n, of_stress:of_stress + 1) = 0
         end if
         column(:n, of_u_rate) = of%x_dot(:n) + of%u_dot(:n)
         column(:n, of_turn) = of%theta_ddot(:n)
         column(:n, of_ground) = of%ground(:n)
         column(:n, of_upward) = of%upward(:n)
         column(:n, of_total) = (of%shear(:n) - of%force(:n, 1) - of%anchor(:n)) &
            /(scene%g*(1 + scene%frame%mass(1, 1) + sum(scene%frame%m(:scene%frame%free))))
         do i = 1, size(scene%springs)
            k = first_spring(scene) + i - 1
            column(:n, k) = of%device%stretch(:n, i)
            k = k + size(scene%springs)
            weight = scene%g
            if (i > scene%fuses) weight = scene%g*sum(scene%frame%m)
            column(:n, k) = regime%springs(i)%slope/weight*of%device%stretch(:n, i)
            column(0, k) = column(0, k) + regime%springs(i)%offset/weight
         end do
         column(:n, of_drift) = (of%x(:n) + 2*scene%h*of%turn%sine(:n))/(2*scene%h)
      end associate
      if (scene%frame%n > 0) call fill_floors(scene, series, record)
   end subroutine fill_columns

   !> Set the columns of the floors.
   pure subroutine fill_floors(scene, series, record)
      type(base_scene_t), intent(in) :: scene
      type(base_series_t), intent(in) :: series
      type(base_record_t), intent(inout) :: record
      real(wp) :: place(0:highest_order), below(0:highest_order)
      integer :: i

      associate (of => series, frame => scene%frame, n => series%order)
         below = 0
         do i = 1, frame%n
            if (i <= frame%free) then
               place(:n) = of%q(:n, i)
               record%series(:n, first_floor + frame%n + i - 1) = (of%q_ddot(:n, i) &
                  + of%ground(:n))/scene%g
            else
               place(:n) = of%x(:n) + frame%follows(i, 2)*of%u(:n)
               record%series(:n, first_floor + frame%n + i - 1) = (of%x_ddot(:n) &
                  + frame%follows(i, 2)*of%u_ddot(:n) + of%ground(:n))/scene%g
            end if
            if (.not. allocated(frame%height)) cycle
            record%series(:n, first_floor + i - 1) = (place(:n) - below(:n))/frame%height(i)
            below(:n) = place(:n)
         end do
      end associate
   end subroutine fill_floors

   !> Update the largest stress of the strips.
   pure subroutine observe_strips(scene, regime, h, series, stress)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: h
      !! [s]
      type(base_series_t), intent(in) :: series
      real(wp), intent(inout) :: stress
      !! [m]
      real(wp) :: c(0:highest_order), extremes(2), times(2)
      integer :: i

      do i = 1, scene%strips
         associate (n => series%order, xi => scene%place(i))
            select case (regime%strips(i))
            case (is_pressed)
               c(:n) = xi*series%contact%a2(:n) - series%contact%b2(:n)
               c(0) = c(0) - regime%depth(i)
            case (is_crushing)
               c(:n) = scene%delay*(xi*series%turn%cosine_rate(:n) - series%z_dot(:n))
               c(0) = c(0) + scene%d_y
            case default
               cycle
            end select
            extremes = [-huge(stress), stress]
            call keep_extremes(c(:n), 0.0_wp, h, extremes, times)
            stress = extremes(2)
         end associate
      end do
   end subroutine observe_strips

   !> Add the work over a step.
   pure subroutine add_work(scene, regime, h, series, record)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: h
      !! [s]
      type(base_series_t), intent(in) :: series
      type(base_record_t), intent(inout) :: record
      real(wp), dimension(0:highest_order) :: push, lift, rate
      real(wp) :: flow(0:highest_order, 2 + scene%frame%free)
      real(wp) :: rates(0:highest_order, 2 + scene%frame%free)
      real(wp) :: power
      integer :: i, k

      associate (of => series, frame => scene%frame, n => series%order, energy => record%energy)
         rates(:n, 1) = of%x_dot(:n)
         rates(:n, 2) = of%u_dot(:n)
         rates(:n, 3:) = of%q_dot(:n, :)
         push(:n) = of%x_dot(:n) + scene%h*of%turn%cosine_rate(:n)
         if (frame%n > 0) then
            push(:n) = push(:n) + matmul(rates(:n, :), [frame%excited, frame%m(:frame%free)])
            flow(:n, :) = matmul(rates(:n, :), frame%c)
         end if
         lift(:n) = of%z_dot(:n) - scene%h*of%turn%sine_rate(:n)
         do k = 0, n
            power = -product_term(k, of%ground, push) - product_term(k, of%upward, lift)
            energy%input = energy%input + power*h**(k + 1)/(k + 1)
            power = product_term(k, of%turn%cosine_rate, of%moment) - product_term(k, of%z_dot, &
               of%normal)
            record%base_work = record%base_work + power*h**(k + 1)/(k + 1)
            if (regime%slip /= 0) record%friction = record%friction - product_term(k, of%x_dot, &
               of%shear)*h**(k + 1)/(k + 1)
            do i = 1, merge(2 + frame%free, 0, frame%n > 0)
               energy%viscous = energy%viscous + product_term(k, flow(:, i), rates(:, i)) &
                  *h**(k + 1)/(k + 1)
            end do
         end do
         do i = 1, size(scene%devices)
            if (.not. scene%devices(i)%c > 0) cycle
            rate(:n) = of%device%rise_dot(:n) - 2*scene%devices(i)%offset*of%device%sine_rate(:n)
            do k = 0, n
               energy%viscous = energy%viscous + scene%devices(i)%c*product_term(k, rate, rate) &
                  *h**(k + 1)/(k + 1)
            end do
         end do
         energy%input_max = max(energy%input_max, abs(energy%input))
      end associate
   end subroutine add_work

   !> Energies of a state.
   pure type(stored_t) function stored_energies(scene, regime, y) result(stored)
      type(base_scene_t), intent(in) :: scene
      type(base_regime_t), intent(in) :: regime
      real(wp), intent(in) :: y(:)
      !! (states) as of `set_state`
      real(wp) :: w(2 + scene%frame%free), rate(2 + scene%frame%free)
      real(wp) :: elastic(size(scene%springs))
      !! energies of the springs [J/kg]
      real(wp) :: s, c, stretch

      s = sin(y(1))
      c = cos(y(1))
      associate (h => scene%h, b => scene%b, frame => scene%frame, z => y(5))
         stored%kinetic = ((y(4) + h*c*y(2))**2 + (y(6) - h*s*y(2))**2 + (h**2 + b**2)/3*y(2)**2)/2
         if (frame%n > 0) then
            w = [y(3), 2*h*s + 2*b*sin(y(1)/2)**2, y(7:6 + frame%free)]
            rate = [y(4), (2*h*c + b*s)*y(2), y(7 + frame%free:)]
            stored%kinetic = stored%kinetic + dot_product(rate(:2), matmul(frame%mass, &
               rate(:2)))/2 + sum(frame%m(:frame%free)*rate(3:)**2)/2
            stored%strain = dot_product(w, matmul(frame%k, w))/2
         end if
         stored%gravity = scene%g*(z - scene%z_0 - 2*h*sin(y(1)/2)**2)
         if (scene%has_tendon) then
            stretch = sqrt((y(3) + 2*h*s)**2 + (z + 2*h*c)**2) - scene%l_0
            if (.not. regime%is_taut) stretch = -scene%eta_0/scene%eta_slope
            stored%cable = scene%g*stretch*(scene%eta_0 + scene%eta_slope*stretch/2)
         end if
         elastic = spring_energy(scene%springs, regime%springs, elongations(scene, y))
         stored%fuses = sum(elastic(:scene%fuses))
         stored%strain = stored%strain + sum(elastic(scene%fuses + 1:))
         if (scene%strips > 0) then
            stored%base = sum(min(scene%d_y, max(0.0_wp, scene%place*s - z - regime%depth))**2) &
               *scene%width
         else
            stored%base = compression(abs(s), z)
         end if
         stored%base = scene%kappa/2*stored%base
      end associate

   contains

      !> Integral of the squared settlement over the base [m3].
      pure real(wp) function compression(s, z) result(square)
         real(wp), intent(in) :: s, z

         if (-scene%b*s - z >= 0) then
            square = 2*scene%b*z**2 + 2*scene%b**3*s**2/3
         else
            square = max(0.0_wp, scene%b*s - z)**3/(3*s)
         end if
      end function compression
   end function stored_energies

end module rwmf_simulation_base_base_record
